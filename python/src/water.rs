//! Waters: from images, files and published tables.

use std::path::PathBuf;

use aquafuse::depth::{DepthKind, RelativeScale};
use aquafuse::image::Linear;
use aquafuse::waterbody::presets::{Conditions, Preset, White};
use aquafuse::waterbody::{Quality, Reason};
use aquafuse_data::image_file::{ImageFile, ReadOptions};
use aquafuse_data::pipeline::{PixelEncoding, WaterEstimate};
use aquafuse_data::water_file::{Numbers, WaterFile, WaterFileError, has_suffix};
use pyo3::prelude::*;

use crate::array::take;
use crate::error::Fault;
use crate::operations::scene;
use crate::settings::{Reading, encoding};
use crate::threads;

/// A waterbody with its sources, intervals and verdict.
#[pyclass(frozen, module = "aquafuse._native")]
#[derive(Clone)]
pub(crate) struct Water {
    file: WaterFile,
    /// A preset knows the light on its scene, which a file does not hold.
    preset: Option<(Preset, f64, String)>,
}

/// A visibility in metres, if it can be one.
pub(crate) fn checked(visibility: Option<f32>) -> Result<Option<f32>, Fault> {
    match visibility {
        Some(metres) if !(0.1..=1000.0).contains(&metres) => {
            Err(Fault::argument(format!("visibility is {metres}; give 0.1 to 1000 metres")))
        }
        _ => Ok(visibility),
    }
}

/// A triple for red, green and blue of some numbers each.
type Rgb<T> = (T, T, T);

fn rgb<T: Copy>([r, g, b]: [T; 3]) -> Rgb<T> {
    (r, g, b)
}

/// The reasons of a verdict as files name them.
pub(crate) fn reason_names(quality: Quality) -> Vec<String> {
    let name =
        |reason: Reason| serde_json::to_value(reason).ok().and_then(|name| name.as_str().map(str::to_owned));
    quality.reasons.iter().filter_map(name).collect()
}

impl Water {
    pub(crate) fn of_estimate(from: &str, depth_kind: DepthKind, estimate: WaterEstimate) -> Self {
        Self { file: WaterFile { from: vec![from.to_owned()], depth_kind, estimate }, preset: None }
    }

    pub(crate) fn encoding(&self) -> PixelEncoding {
        self.file.estimate.encoding()
    }

    /// The water per unit of a kind of depth, with another visibility in metres if one is given.
    pub(crate) fn per(
        &self,
        kind: DepthKind,
        scale: RelativeScale,
        visibility: Option<f32>,
    ) -> Result<WaterEstimate, Fault> {
        Ok(self.file.seen(kind, scale, checked(visibility)?)?)
    }

    pub(crate) fn file(&self) -> &WaterFile {
        &self.file
    }

    /// The light on the scene relative to daylight: that of a preset below the surface, else 1.
    pub(crate) fn light(&self) -> Result<[f32; 3], Fault> {
        match &self.preset {
            Some((preset, below, camera)) => Ok(preset.derive::<Linear>(&conditions(*below, camera)?).white),
            None => Ok([1.0; 3]),
        }
    }

    pub(crate) fn depth_kind_name(&self) -> &'static str {
        match self.file.depth_kind {
            DepthKind::Metres => "metres",
            _ => "relative",
        }
    }

    fn numbers(&self) -> Numbers {
        Numbers::from(&self.file.estimate)
    }
}

fn conditions(below_surface: f64, camera: &str) -> Result<Conditions, Fault> {
    let white = match camera {
        "daylight" => White::Daylight,
        "at-depth" => White::AtDepth,
        "at-surface" => White::AtSurface,
        _ => {
            return Err(Fault::argument(format!(
                "there is no camera {camera:?}; give daylight, at-depth or at-surface"
            )));
        }
    };
    let conditions = Conditions::default().with_white(white);
    conditions.with_depth_below_surface(below_surface).map_err(Fault::argument)
}

/// How an image is read that gives its water: a border in numbers belongs to the contents.
fn of_reference(reading: &Reading) -> Result<ReadOptions, Fault> {
    let scene = reading.scene()?;
    Ok(ReadOptions { border: scene.border.of_reference(), ..scene })
}

#[pymethods]
impl Water {
    /// The water that an image was taken in.
    #[staticmethod]
    fn of_array(
        image: &Bound<'_, PyAny>,
        depth: Option<&Bound<'_, PyAny>>,
        depth_kind: Option<&str>,
        reading: Reading,
        name: &str,
    ) -> PyResult<Self> {
        let (how, depth) = (of_reference(&reading)?, reading.depth(depth, depth_kind)?);
        let pixels = take(image)?.pixels;
        let (py, (image, depth)) = (image.py(), scene(image.py(), pixels, &how, depth)?);
        let found = threads::work(py, || depth.analyse(reading.encoding(), &image))?;
        Ok(Self::of_estimate(name, found.depth.kind(), found.estimate))
    }

    /// The water of a file: an image, or a *.water.json.
    #[staticmethod]
    fn of_file(
        py: Python<'_>,
        path: PathBuf,
        depth: Option<&Bound<'_, PyAny>>,
        depth_kind: Option<&str>,
        reading: Reading,
    ) -> PyResult<Self> {
        if has_suffix(&path) {
            let file = threads::work(py, || Ok(WaterFile::read(&path, reading.encoding())?))?;
            return Ok(Self { file, preset: None });
        }
        let (options, depth) = (of_reference(&reading)?, reading.depth(depth, depth_kind)?);
        let name = aquafuse_data::files::display(&path).to_string();
        let image = threads::work(py, || Ok(ImageFile::open(&path, &options)?.decode()?))?;
        let depth = depth.known(py, &image)?;
        let found = threads::work(py, || depth.analyse(reading.encoding(), &image))?;
        Ok(Self::of_estimate(&name, found.depth.kind(), found.estimate))
    }

    /// A drawn water by its number.
    #[staticmethod]
    fn of_sea(number: u32, linear: bool) -> Self {
        Self { file: WaterFile::sea(number, encoding(linear)), preset: None }
    }

    /// The water of a published table.
    #[staticmethod]
    fn of_preset(name: &str, below_surface: f64, camera: &str, linear: bool) -> Result<Self, Fault> {
        let preset: Preset = name.parse()?;
        let estimate = WaterEstimate::preset(preset, &conditions(below_surface, camera)?, encoding(linear));
        let from = format!("preset:{}", preset.name());
        let preset = Some((preset, below_surface, camera.to_owned()));
        Ok(Self { preset, ..Self::of_estimate(&from, DepthKind::Metres, estimate) })
    }

    /// The names of the presets.
    #[staticmethod]
    fn preset_names() -> Vec<&'static str> {
        Preset::ALL.iter().map(|preset| preset.name()).collect()
    }

    /// One water from several.
    #[staticmethod]
    fn of_many(waters: Vec<PyRef<'_, Self>>) -> Result<Self, Fault> {
        let estimates: Vec<_> = waters.iter().map(|water| water.file.estimate).collect();
        let kinds: Vec<_> = waters.iter().map(|water| water.file.depth_kind).collect();
        let kind = kinds.first().copied().filter(|first| kinds.iter().all(|kind| kind == first));
        let (Some(depth_kind), Some(estimate)) = (kind, WaterEstimate::pool(&estimates)) else {
            return Err(Fault::argument(
                "waters are pooled if there is one at least, and all are per one unit of depth and of one encoding",
            ));
        };
        let from = waters.iter().flat_map(|water| water.file.from.clone()).collect();
        Ok(Self { file: WaterFile { from, depth_kind, estimate }, preset: None })
    }

    /// The water in the text of a *.water.json.
    #[staticmethod]
    fn of_json(text: &str) -> Result<Self, Fault> {
        let parse = |encoding| WaterFile::from_text("this text".as_ref(), text, encoding);
        let file = match parse(PixelEncoding::Encoded) {
            Err(WaterFileError::Encoding { found, .. }) => parse(found)?,
            other => other?,
        };
        Ok(Self { file, preset: None })
    }

    /// The text of a *.water.json.
    fn to_json(&self) -> String {
        self.file.to_text()
    }

    fn save(&self, path: PathBuf, overwrite: bool) -> Result<(), Fault> {
        Ok(self.file.write(&path, overwrite)?)
    }

    /// What a preset was made from: name, depth below the surface, camera.
    #[getter]
    fn preset(&self) -> Option<(&'static str, f64, String)> {
        self.preset.as_ref().map(|(preset, below, camera)| (preset.name(), *below, camera.clone()))
    }

    #[getter]
    fn sources(&self) -> Vec<String> {
        self.file.from.clone()
    }

    #[getter]
    fn depth_kind(&self) -> &'static str {
        self.depth_kind_name()
    }

    #[getter(encoding)]
    fn encoding_name(&self) -> &'static str {
        self.encoding().name()
    }

    #[getter]
    fn verdict(&self) -> &'static str {
        self.file.estimate.quality().verdict.name()
    }

    #[getter]
    fn reasons(&self) -> Vec<String> {
        reason_names(self.file.estimate.quality())
    }

    #[getter]
    fn veiling_light(&self) -> Rgb<f32> {
        rgb(self.numbers().veiling_light)
    }

    /// The veiling light as it looks, encoded.
    #[getter]
    fn colour(&self) -> Rgb<f32> {
        rgb(self.file.estimate.veiling_light_as_seen())
    }

    #[getter]
    fn backscatter_coefficient(&self) -> Rgb<f32> {
        rgb(self.numbers().backscatter_coefficient)
    }

    #[getter]
    fn attenuation(&self) -> Rgb<(f32, f32, f32, f32)> {
        rgb(self.numbers().attenuation.map(|[a, b, c, d]| (a, b, c, d)))
    }

    #[getter]
    fn attenuation_held_beyond(&self) -> Rgb<f32> {
        rgb(self.numbers().attenuation_held_beyond)
    }

    #[getter]
    fn veiling_light_interval(&self) -> Rgb<(f32, f32)> {
        rgb(self.file.estimate.intervals().veiling_light.map(Into::into))
    }

    #[getter]
    fn backscatter_coefficient_interval(&self) -> Rgb<(f32, f32)> {
        rgb(self.file.estimate.intervals().backscatter_coefficient.map(Into::into))
    }

    /// How far one sees, in the unit of depth.
    #[getter]
    fn visibility(&self) -> Option<f32> {
        match &self.file.estimate {
            WaterEstimate::Encoded(estimate) => estimate.water.visibility(),
            WaterEstimate::Linear(estimate) => estimate.water.visibility(),
        }
    }

    /// What is left of the direct signal at distance z.
    fn illumination(&self, z: f32) -> Rgb<f32> {
        rgb(self.file.estimate.illumination(z))
    }

    /// The backscatter at distance z.
    fn backscatter(&self, z: f32) -> Rgb<f32> {
        rgb(match &self.file.estimate {
            WaterEstimate::Encoded(estimate) => estimate.water.backscatter(z),
            WaterEstimate::Linear(estimate) => estimate.water.backscatter(z),
        })
    }

    /// The same water with another visibility, in the unit of its depth.
    fn with_visibility(&self, distance: f32) -> Result<Self, Fault> {
        let estimate = self.file.estimate.with_visibility(distance)?;
        Ok(Self { file: WaterFile { estimate, ..self.file.clone() }, preset: None })
    }
}
