//! Arrays of numpy and tensors of torch as images, and back.

use aquafuse::depth::{Supplied, SuppliedKind};
use aquafuse::image::{Image, Sample};
use aquafuse_data::image_file::{Pixels, ReadOptions};
use numpy::ndarray::{Array2, Array3};
use numpy::{
    Element, PyArray2, PyArray3, PyArrayDescrMethods, PyArrayDyn, PyArrayMethods, PyUntypedArray,
    PyUntypedArrayMethods,
};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::PyString;

use crate::error::Fault;

/// What the caller gave, which decides what the caller gets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Container {
    /// An array of shape (height, width, 3).
    Array,
    /// A tensor of shape (3, height, width).
    Tensor,
}

/// An image that was taken from Python, copied once.
pub(crate) struct Taken {
    pub(crate) pixels: Pixels,
    pub(crate) container: Container,
}

/// Takes an image: an array of shape (height, width, 3), or a tensor of torch of shape (3, height, width).
pub(crate) fn take(object: &Bound<'_, PyAny>) -> PyResult<Taken> {
    let (array, container) = shared(object, "an image")?;
    let shape = array.shape();
    let &[height, width, 3] = shape else {
        let message = match container {
            Container::Array => {
                format!("an image has the shape (height, width, 3), not {}; {}", listed(shape), remedy(shape))
            }
            Container::Tensor => format!(
                "an image as a tensor has the shape (3, height, width), not {}; move its channels by \
                 tensor.permute(2, 0, 1), and give one image of a batch at a time",
                listed(&object.getattr("shape")?.extract::<Vec<usize>>()?)
            ),
        };
        return Err(Fault::array(message).into());
    };
    if height == 0 || width == 0 {
        return Err(
            Fault::array(format!("the image has {width} columns and {height} rows: it is empty")).into()
        );
    }
    check_pixels("image", width, height)?;
    let pixels = if let Ok(array) = array.cast::<PyArray3<u8>>() {
        Pixels::from(image::<u8>(width, height, samples(array.as_untyped())?)?)
    } else if let Ok(array) = array.cast::<PyArray3<u16>>() {
        Pixels::from(image::<u16>(width, height, samples(array.as_untyped())?)?)
    } else if let Ok(array) = array.cast::<PyArray3<f32>>() {
        Pixels::from(image::<f32>(width, height, samples(array.as_untyped())?)?)
    } else {
        let message = format!(
            "an image has the dtype uint8, uint16 or float32 (0 to 1) in the byte order of this machine, not {}; convert \
             it, for example by .astype(numpy.float32)",
            array.dtype().str()?
        );
        return Err(Fault::array(message).into());
    };
    Ok(Taken { pixels, container })
}

/// Refuses what is too large before memory is taken: an array may repeat one value at a thousand million places.
fn check_pixels(what: &str, width: usize, height: usize) -> Result<(), Fault> {
    let (pixels, most) = (height.saturating_mul(width) as u64, ReadOptions::default().max_pixels);
    match pixels <= most {
        true => Ok(()),
        false => Err(Fault::array(format!(
            "the {what} has {pixels} pixels, and {most} are the limit; give a part of it, or a smaller one"
        ))),
    }
}

fn image<T: Sample>(width: usize, height: usize, samples: Vec<T>) -> Result<Image<T>, Fault> {
    Ok(Image::from_raw(width, height, samples)?)
}

fn listed(shape: &[usize]) -> String {
    let sides: Vec<String> = shape.iter().map(ToString::to_string).collect();
    format!("({})", sides.join(", "))
}

/// What to do about a shape that is no image's.
fn remedy(shape: &[usize]) -> &'static str {
    match shape {
        [_, _, 4] => "drop the opacity: image[..., :3]",
        [_, _] | [_, _, 1] => "repeat grey three times: numpy.dstack([grey] * 3)",
        [3, _, _] => "move the channels to the end: image.transpose(1, 2, 0)",
        [_, _, _, _] => "give one image of the batch at a time",
        _ => "give the pixels of one colour image",
    }
}

/// The values of an array in order, copied once; twice if they lie in another order in memory.
fn samples<T: Element + Copy>(array: &Bound<'_, PyUntypedArray>) -> PyResult<Vec<T>> {
    let py = array.py();
    let is_plain = array.is_c_contiguous()
        && array.getattr(intern!(py, "flags"))?.getattr(intern!(py, "aligned"))?.is_truthy()?;
    let plain = match is_plain {
        true => array.clone().into_any(),
        false => py
            .import(intern!(py, "numpy"))?
            .call_method1(intern!(py, "require"), (array, py.None(), ["C", "A"]))?,
    };
    let plain = plain.cast_into::<PyArrayDyn<T>>()?;
    let values =
        plain.try_readonly().map_err(|error| Fault::array(format!("{error}: wait for the other call")))?;
    let values = values.as_slice().map_err(|error| Fault::array(error.to_string()))?;
    Ok(values.to_vec())
}

/// The memory of an object as an array whose channels come last, without a copy.
fn shared<'py>(object: &Bound<'py, PyAny>, what: &str) -> PyResult<(Bound<'py, PyUntypedArray>, Container)> {
    if let Ok(array) = object.cast::<PyUntypedArray>() {
        return Ok((array.clone(), Container::Array));
    }
    let py = object.py();
    if is_tensor(object)? {
        let device =
            object.getattr(intern!(py, "device"))?.getattr(intern!(py, "type"))?.extract::<String>()?;
        if device != "cpu" {
            let message =
                format!("this tensor is on {device}, and aquafuse works on the CPU; pass tensor.cpu()");
            return Err(Fault::array(message).into());
        }
        let plain = object.call_method0(intern!(py, "detach"))?.call_method0(intern!(py, "numpy"));
        let plain = plain.map_err(|error| {
            Fault::array(format!("cannot share the memory of this tensor: {error}; pass tensor.float()"))
        })?;
        let mut array = plain.cast_into::<PyUntypedArray>()?;
        if array.ndim() == 3 {
            array = array.call_method1(intern!(py, "transpose"), (1, 2, 0))?.cast_into()?;
        }
        return Ok((array, Container::Tensor));
    }
    if object.hasattr(intern!(py, "__array_interface__"))? || object.hasattr(intern!(py, "__array__"))? {
        let array = py.import(intern!(py, "numpy"))?.call_method1(intern!(py, "asarray"), (object,));
        let array = array.map_err(|error| {
            Fault::array(format!("cannot read this object as an array: {error}; pass a numpy array"))
        })?;
        return Ok((array.cast_into()?, Container::Array));
    }
    let name = object.get_type().qualname()?;
    let is_path = object.is_instance_of::<PyString>() || object.hasattr(intern!(py, "__fspath__"))?;
    let remedy = match is_path {
        true => "read the file first, for example by numpy.asarray(PIL.Image.open(path))",
        false => "pass numpy.asarray(...)",
    };
    Err(Fault::array(format!(
        "{what} is a numpy array or a tensor of torch on the CPU, not {name}; {remedy}"
    ))
    .into())
}

/// Whether an object is a tensor of torch, which is never imported for that.
fn is_tensor(object: &Bound<'_, PyAny>) -> PyResult<bool> {
    let modules =
        object.py().import(intern!(object.py(), "sys"))?.getattr(intern!(object.py(), "modules"))?;
    let torch = modules.call_method1(intern!(object.py(), "get"), ("torch",))?;
    match torch.is_none() || !torch.hasattr(intern!(object.py(), "Tensor"))? {
        true => Ok(false),
        false => object.is_instance(&torch.getattr(intern!(object.py(), "Tensor"))?),
    }
}

/// Gives pixels back as what the image came in, or into `out`, which has the same shape and dtype.
pub(crate) fn give<'py>(
    py: Python<'py>,
    pixels: Pixels,
    container: Container,
    out: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let array = match pixels {
        Pixels::Bytes(layers) => array_of(py, layers.image)?,
        Pixels::Words(layers) => array_of(py, layers.image)?,
        Pixels::Floats(layers) => array_of(py, layers.image)?,
    };
    match (out, container) {
        (Some(out), _) => {
            py.import(intern!(py, "numpy"))?
                .call_method1(intern!(py, "copyto"), (shared(out, "out")?.0, array))?;
            Ok(out.clone())
        }
        (None, Container::Array) => Ok(array),
        (None, Container::Tensor) => {
            let tensor =
                py.import(intern!(py, "torch"))?.call_method1(intern!(py, "from_numpy"), (array,))?;
            tensor.call_method1(intern!(py, "permute"), (2, 0, 1))
        }
    }
}

/// Refuses an `out` that cannot take the result, before any work.
pub(crate) fn check_out(out: Option<&Bound<'_, PyAny>>, taken: &Taken) -> PyResult<()> {
    let Some(out) = out else { return Ok(()) };
    let (array, _) = shared(out, "out")?;
    let (width, height) = taken.pixels.size();
    let fits = array.shape() == [height, width, 3];
    let dtype = match &taken.pixels {
        Pixels::Bytes(_) => numpy::dtype::<u8>(out.py()),
        Pixels::Words(_) => numpy::dtype::<u16>(out.py()),
        Pixels::Floats(_) => numpy::dtype::<f32>(out.py()),
    };
    if !fits || !array.dtype().is_equiv_to(&dtype) {
        let (found, wanted) = (listed(array.shape()), listed(&[height, width, 3]));
        let message = format!(
            "out has the shape {found} and dtype {}, but the result has {wanted} and {}; use numpy.empty_like(image)",
            array.dtype().str()?,
            dtype.str()?
        );
        return Err(Fault::array(message).into());
    }
    if !array.getattr("flags")?.getattr("writeable")?.is_truthy()? {
        return Err(Fault::array("out is read-only; pass an array that may be written").into());
    }
    Ok(())
}

/// An image as an array of shape (height, width, 3).
pub(crate) fn array_of<T: Sample + Element>(py: Python<'_>, image: Image<T>) -> PyResult<Bound<'_, PyAny>> {
    let (width, height) = image.size();
    let array = Array3::from_shape_vec((height, width, 3), image.into_raw());
    let array = array.map_err(|error| Fault::array(error.to_string()))?;
    Ok(PyArray3::from_owned_array(py, array).into_any())
}

/// One value for each pixel as an array of shape (height, width).
pub(crate) fn plane(
    py: Python<'_>,
    (width, height): (usize, usize),
    values: Vec<f32>,
) -> PyResult<Bound<'_, PyArray2<f32>>> {
    let array = Array2::from_shape_vec((height, width), values);
    Ok(PyArray2::from_owned_array(py, array.map_err(|error| Fault::array(error.to_string()))?))
}

/// Takes a depth map of a declared kind: an array or a tensor of shape (height, width), of float or whole numbers.
pub(crate) fn take_depth(object: &Bound<'_, PyAny>, kind: SuppliedKind) -> PyResult<Supplied> {
    let py = object.py();
    let (array, _) = shared(object, "depth")?;
    let &[height, width] = array.shape() else {
        let found = listed(array.shape());
        return Err(Fault::array(format!(
            "depth has the shape (height, width), not {found}; pass one value for each pixel"
        ))
        .into());
    };
    check_pixels("depth map", width, height)?;
    let full_range = match array.dtype().kind() {
        b'f' => None,
        b'u' => Some(2_f32.powi(8 * i32::try_from(array.dtype().itemsize()).unwrap_or(1)) - 1.0),
        _ => {
            let message = format!(
                "depth is of float or unsigned whole numbers, not {}; convert it by .astype(numpy.float32)",
                array.dtype().str()?
            );
            return Err(Fault::array(message).into());
        }
    };
    let floats = array.call_method1(intern!(py, "astype"), ("float32",))?;
    let floats = floats.cast_into::<PyUntypedArray>()?;
    let map = Supplied::new(width, height, samples(&floats)?, kind).map_err(Fault::from)?;
    Ok(full_range.map_or_else(|| map.clone(), |most| map.clone().with_full_range(most)))
}
