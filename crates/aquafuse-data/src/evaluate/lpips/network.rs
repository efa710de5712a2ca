//! The network, read from a file of ONNX.

use std::fmt;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use aquafuse::image::{Image, Sample};
use rten::{Model, NodeId, RunOptions, ThreadPool, Value};

use crate::evaluate::EvaluateError;
use crate::files::catch_panic;
use crate::files::sha256;
use crate::files::{FileError, one_line};
use crate::image_file::open_file;

/// The network of LPIPS with its weights.
///
/// Two inputs of 1 x 3 x height x width, RGB from -1 to 1, and one output of one number, 0 for equal images.
#[derive(Clone)]
pub struct Lpips {
    path: PathBuf,
    sha256: String,
    model: Arc<Model>,
    inputs: [NodeId; 2],
    output: NodeId,
    /// One thread: images are shared out already, and sums then do not depend on how many there are.
    alone: Arc<ThreadPool>,
}

impl fmt::Debug for Lpips {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Lpips").field(&self.path).finish()
    }
}

impl Lpips {
    /// Reads a network.
    ///
    /// # Errors
    ///
    /// [`EvaluateError`] when the file cannot be read, or holds no network of two inputs and one output.
    pub fn read(path: &Path) -> Result<Self, EvaluateError> {
        let (mut file, length) = open_file(path)?;
        let mut bytes = Vec::new();
        let read = Read::by_ref(&mut file).take(length).read_to_end(&mut bytes);
        read.map_err(|error| FileError::Read { path: path.to_owned(), error })?;
        let unfit = |cause: String| EvaluateError::NoLpips { path: path.to_owned(), cause: one_line(&cause) };
        let sha256 = sha256(&bytes);
        let model = catch_panic(|| Model::load(bytes)).ok_or_else(|| unfit("its reader panicked".into()))?;
        let model = model.map_err(|error| unfit(error.to_string()))?;
        let (inputs, outputs) = (model.input_ids(), model.output_ids());
        let (&[a, b], &[output]) = (inputs, outputs) else {
            let (inputs, outputs) = (inputs.len(), outputs.len());
            return Err(unfit(format!(
                "it has {inputs} inputs and {outputs} outputs instead of two and one"
            )));
        };
        let alone = Arc::new(ThreadPool::with_num_threads(1));
        Ok(Self { path: path.to_owned(), sha256, model: Arc::new(model), inputs: [a, b], output, alone })
    }

    /// Which network it is, for reports.
    pub(crate) fn described(&self) -> serde_json::Value {
        serde_json::json!({ "file": self.path.to_string_lossy(), "sha256": self.sha256 })
    }

    /// The distance of two images of one size.
    ///
    /// # Errors
    ///
    /// [`EvaluateError`] when the network cannot take images of their size.
    pub fn distance(&self, a: &Image<u8>, b: &Image<u8>) -> Result<f64, EvaluateError> {
        let unfit =
            |cause: String| EvaluateError::NoLpips { path: self.path.clone(), cause: one_line(&cause) };
        let options = RunOptions::default().with_thread_pool(Some(self.alone.clone()));
        let [first, second] = self.inputs;
        let inputs = vec![(first, input(a)), (second, input(b))];
        let inputs = inputs.into_iter().map(|(node, value)| (node, value.into())).collect();
        let run = || self.model.run_n(inputs, [self.output], Some(options));
        let ended = catch_panic(run).ok_or_else(|| unfit("it panicked on images of this size".into()))?;
        let [output] = ended.map_err(|error| unfit(error.to_string()))?;
        let values = output.as_tensor_view::<f32>().map(|values| values.iter().copied().collect::<Vec<_>>());
        match values.as_deref() {
            Some([distance]) => Ok(f64::from(*distance)),
            other => {
                Err(unfit(format!("it returns {} numbers instead of one", other.map_or(0, <[f32]>::len))))
            }
        }
    }
}

/// Channel by channel, from -1 to 1.
fn input(image: &Image<u8>) -> Value {
    let channel = |c: usize| {
        image.pixels().iter().filter_map(move |pixel| pixel.get(c)).map(|value| 2.0 * value.to_unit() - 1.0)
    };
    let values: Vec<f32> = (0..3).flat_map(channel).collect();
    let shape = [1, 3, image.height(), image.width()];
    Value::from_shape(shape, values).expect("a value for each channel of each pixel")
}
