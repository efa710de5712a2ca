//! The scene: anisotropic Gaussians, each a row of numbers.

use crate::scalar::Scalar;

/// The highest degree of spherical harmonics.
pub const MOST_DEGREE: u8 = 3;
/// The zeroth harmonic: a colour c is kept as (c - 1/2) / this.
pub(crate) const FLAT: f64 = 0.282_094_791_773_878_14;

/// Where the parts of a row begin; harmonics are the rest of it.
pub(crate) const POSITION: usize = 0;
pub(crate) const LOG_SCALE: usize = 3;
pub(crate) const ROTATION: usize = 6;
pub(crate) const OPACITY: usize = 10;
pub(crate) const HARMONICS: usize = 11;

/// Gaussians in the parameters they are trained in, as published by Kerbl et al.
///
/// Each is a row of 11 + 3 (degree + 1)² numbers: position (3, units of the scene), logarithms of the deviations along
/// its axes (3), a quaternion w, x, y, z that is normalised where it is used (4), the logit of its opacity (1), and
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
    /// None yet, with harmonics up to `degree`.
    ///
    /// # Panics
    ///
    /// When `degree` is more than [`MOST_DEGREE`].
    pub fn new(degree: u8) -> Self {
        assert!(degree <= MOST_DEGREE, "harmonics are known up to degree {MOST_DEGREE}, not {degree}");
        Self { degree, rows: Vec::new() }
    }

    /// So many rows of zeros in the shape of these: a gradient to add to.
    #[must_use]
    pub fn zeros(&self) -> Self {
        Self { degree: self.degree, rows: vec![T::ZERO; self.rows.len()] }
    }

    /// Takes rows as they are; none if they are no whole number of rows.
    pub fn from_rows(degree: u8, rows: Vec<T>) -> Option<Self> {
        (degree <= MOST_DEGREE && rows.len().is_multiple_of(Self::width_of(degree)))
            .then_some(Self { degree, rows })
    }

    /// A row: a ball of one colour, of deviation `radius` and the given opacity in (0, 1).
    pub fn ball(degree: u8, position: [f64; 3], radius: f64, opacity: f64, colour: [f64; 3]) -> Vec<T> {
        let mut row = vec![T::ZERO; Self::width_of(degree)];
        for i in 0..3 {
            row[POSITION + i] = T::of(position[i]);
            row[LOG_SCALE + i] = T::of(radius.ln());
            row[HARMONICS + i] = T::of((colour[i] - 0.5) / FLAT);
        }
        row[ROTATION] = T::ONE;
        row[OPACITY] = T::of((opacity / (1.0 - opacity)).ln());
        row
    }

    /// How many.
    pub fn len(&self) -> usize {
        self.rows.len() / self.width()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// The degree of the harmonics.
    pub fn degree(&self) -> u8 {
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
    /// When there is none of that number.
    pub fn row(&self, i: usize) -> &[T] {
        let width = self.width();
        &self.rows[i * width..][..width]
    }

    /// Adds a row.
    ///
    /// # Panics
    ///
    /// When it is no row of this degree.
    pub fn push(&mut self, row: &[T]) {
        assert_eq!(row.len(), self.width(), "a row of degree {}", self.degree);
        self.rows.extend_from_slice(row);
    }

    /// Keeps those of which `keep` says so, in their order.
    pub(crate) fn retain(&mut self, keep: &[bool]) {
        let width = self.width();
        let mut kept = 0;
        for (i, _) in keep.iter().enumerate().filter(|(_, keep)| **keep) {
            self.rows.copy_within(i * width..(i + 1) * width, kept * width);
            kept += 1;
        }
        self.rows.truncate(kept * width);
    }

    /// Where one is.
    pub fn position(&self, i: usize) -> [T; 3] {
        part(self.row(i), POSITION)
    }

    /// Its deviations along its own axes.
    pub fn scale(&self, i: usize) -> [T; 3] {
        part::<T, 3>(self.row(i), LOG_SCALE).map(T::exp)
    }

    /// How it is turned: a unit quaternion w, x, y, z.
    pub fn rotation(&self, i: usize) -> [T; 4] {
        let raw: [T; 4] = part(self.row(i), ROTATION);
        let square = raw.into_iter().fold(T::ZERO, |sum, q| sum + q * q);
        let length = square.sqrt().at_least(T::of(1e-12));
        raw.map(|q| q / length)
    }

    /// How much of what is behind its middle it hides, 0 to 1.
    pub fn opacity(&self, i: usize) -> T {
        self.row(i)[OPACITY].sigmoid()
    }

    /// Its colour without what depends on the direction.
    pub fn colour(&self, i: usize) -> [T; 3] {
        part::<T, 3>(self.row(i), HARMONICS).map(|value| value * T::of(FLAT) + T::of(0.5))
    }

    /// Gives it another colour; what depends on the direction stays.
    pub(crate) fn paint(&mut self, i: usize, colour: [T; 3]) {
        let width = self.width();
        for (c, value) in colour.into_iter().enumerate() {
            self.rows[i * width + HARMONICS + c] = (value - T::of(0.5)) / T::of(FLAT);
        }
    }

    /// The same in other numbers.
    pub fn cast<U: Scalar>(&self) -> Splats<U> {
        Splats { degree: self.degree, rows: self.rows.iter().map(|value| U::of(value.get())).collect() }
    }
}

/// `N` numbers of a row from `at` on.
#[inline(always)]
pub(crate) fn part<T: Scalar, const N: usize>(row: &[T], at: usize) -> [T; N] {
    std::array::from_fn(|i| row[at + i])
}
