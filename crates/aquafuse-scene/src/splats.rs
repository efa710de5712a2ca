//! Splats: anisotropic Gaussians, each a row of numbers.

use crate::scalar::Scalar;

/// The highest degree of spherical harmonics.
pub const MAX_SH_DEGREE: u8 = 3;
/// The spherical harmonic of degree 0: a colour c is stored as (c - 1/2) / this.
pub(crate) const FLAT: f64 = 0.282_094_791_773_878_14;

/// The offsets of the parts of a row; spherical harmonics are the rest of it.
pub(crate) const MEAN: usize = 0;
pub(crate) const LOG_SCALE: usize = 3;
pub(crate) const ROTATION: usize = 6;
pub(crate) const OPACITY: usize = 10;
pub(crate) const HARMONICS: usize = 11;

/// Gaussians in the parameters they are trained in, as published by Kerbl et al.
///
/// Each is a row of 11 + 3 (degree + 1)² numbers: mean (3, units of the scene), logarithms of the scales along its axes
/// (3), a quaternion w, x, y, z that is normalised where it is used (4), the logit of its opacity (1), and spherical
/// harmonics of its colour, three channels each. A gradient has the same shape, and so have the moments of Adam.
///
/// # Examples
///
/// ```
/// use aquafuse_scene::splats::Splats;
///
/// let mut splats = Splats::<f32>::new(0);
/// splats.push(&Splats::<f32>::ball(0, [0.0, 0.0, 4.0], 0.1, 0.5, [1.0, 0.5, 0.0]));
/// assert_eq!(splats.len(), 1);
/// assert!((splats.colour(0)[0] - 1.0).abs() < 1e-6);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Splats<T> {
    degree: u8,
    rows: Vec<T>,
}

/// The harmonics of a degree.
pub(crate) const fn harmonics(degree: u8) -> usize {
    (degree as usize + 1) * (degree as usize + 1)
}

impl<T: Scalar> Splats<T> {
    /// No splats, of this spherical-harmonics degree.
    ///
    /// # Panics
    ///
    /// When `degree` is more than [`MAX_SH_DEGREE`].
    pub fn new(degree: u8) -> Self {
        assert!(degree <= MAX_SH_DEGREE, "harmonics are known up to degree {MAX_SH_DEGREE}, not {degree}");
        Self { degree, rows: Vec::new() }
    }

    /// As many rows of zeros: a gradient to add to.
    #[must_use]
    pub fn zeros(&self) -> Self {
        Self { degree: self.degree, rows: vec![T::ZERO; self.rows.len()] }
    }

    /// Splats of these rows; `None` if the numbers are not whole rows, or the degree is too high.
    pub fn from_rows(degree: u8, rows: Vec<T>) -> Option<Self> {
        (degree <= MAX_SH_DEGREE && rows.len().is_multiple_of(Self::width_of(degree)))
            .then_some(Self { degree, rows })
    }

    /// A row: a ball of one colour, with the scale `radius` along every axis and the given opacity in (0, 1).
    pub fn ball(degree: u8, position: [f64; 3], radius: f64, opacity: f64, colour: [f64; 3]) -> Vec<T> {
        let mut row = vec![T::ZERO; Self::width_of(degree)];
        for i in 0..3 {
            row[MEAN + i] = T::of(position[i]);
            row[LOG_SCALE + i] = T::of(radius.ln());
            row[HARMONICS + i] = T::of((colour[i] - 0.5) / FLAT);
        }
        row[ROTATION] = T::ONE;
        row[OPACITY] = T::of((opacity / (1.0 - opacity)).ln());
        row
    }

    /// The number of splats.
    pub fn len(&self) -> usize {
        self.rows.len() / self.width()
    }

    /// Whether there are no splats.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// The spherical-harmonics degree.
    pub fn sh_degree(&self) -> u8 {
        self.degree
    }

    /// Numbers a row.
    pub fn width(&self) -> usize {
        Self::width_of(self.degree)
    }

    /// Numbers a row of this degree.
    pub(crate) fn width_of(degree: u8) -> usize {
        HARMONICS + 3 * harmonics(degree)
    }

    /// All rows.
    pub fn rows(&self) -> &[T] {
        &self.rows
    }

    /// All rows for writing.
    pub fn rows_mut(&mut self) -> &mut [T] {
        &mut self.rows
    }

    /// One row.
    ///
    /// # Panics
    ///
    /// When there is no row of that index.
    pub fn row(&self, i: usize) -> &[T] {
        let width = self.width();
        &self.rows[i * width..][..width]
    }

    /// Adds a row.
    ///
    /// # Panics
    ///
    /// When the row has another length.
    pub fn push(&mut self, row: &[T]) {
        assert_eq!(row.len(), self.width(), "a row of degree {}", self.degree);
        self.rows.extend_from_slice(row);
    }

    /// Keeps the splats whose entry in `keep` is true, in their order.
    pub(crate) fn retain(&mut self, keep: &[bool]) {
        let width = self.width();
        let mut kept = 0;
        for (i, _) in keep.iter().enumerate().filter(|(_, keep)| **keep) {
            self.rows.copy_within(i * width..(i + 1) * width, kept * width);
            kept += 1;
        }
        self.rows.truncate(kept * width);
    }

    /// The mean of a splat, in units of the scene.
    pub fn mean(&self, i: usize) -> [T; 3] {
        part(self.row(i), MEAN)
    }

    /// The scales of a splat: deviations along its own axes, in units of the scene.
    pub fn scale(&self, i: usize) -> [T; 3] {
        part::<T, 3>(self.row(i), LOG_SCALE).map(T::exp)
    }

    /// The rotation of a splat: a unit quaternion w, x, y, z.
    pub fn rotation(&self, i: usize) -> [T; 4] {
        let raw: [T; 4] = part(self.row(i), ROTATION);
        let square = raw.into_iter().fold(T::ZERO, |sum, q| sum + q * q);
        let length = square.sqrt().at_least(T::of(1e-12));
        raw.map(|q| q / length)
    }

    /// The opacity of a splat at its mean, 0 to 1.
    pub fn opacity(&self, i: usize) -> T {
        self.row(i)[OPACITY].sigmoid()
    }

    /// The colour of a splat without view dependence: its harmonic of degree 0.
    pub fn colour(&self, i: usize) -> [T; 3] {
        part::<T, 3>(self.row(i), HARMONICS).map(|value| value * T::of(FLAT) + T::of(0.5))
    }

    /// Changes the harmonic of degree 0; view dependence stays.
    pub(crate) fn paint(&mut self, i: usize, colour: [T; 3]) {
        let width = self.width();
        for (c, value) in colour.into_iter().enumerate() {
            self.rows[i * width + HARMONICS + c] = (value - T::of(0.5)) / T::of(FLAT);
        }
    }

    /// The same splats in another kind of number.
    pub fn cast<U: Scalar>(&self) -> Splats<U> {
        Splats { degree: self.degree, rows: self.rows.iter().map(|value| U::of(value.get())).collect() }
    }
}

/// `N` numbers of a row from `at` on.
#[inline(always)]
pub(crate) fn part<T: Scalar, const N: usize>(row: &[T], at: usize) -> [T; N] {
    std::array::from_fn(|i| row[at + i])
}
