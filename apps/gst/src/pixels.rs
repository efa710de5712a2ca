//! Frames of each format as red, green and blue, in place where they are that.

mod yuv;

use aquafuse::image::{ImageError, ImageMut};
use gst_video::prelude::*;
use gst_video::{VideoFormat, VideoFrameRef, VideoInfo};

use yuv::{Chroma, Colours};

/// The formats that are read and written. The first is changed where it lies; the others pass through a copy in three bytes a pixel,
/// for which the core has no kernels.
pub const FORMATS: [VideoFormat; 9] = [
    VideoFormat::Rgb,
    VideoFormat::Rgbx,
    VideoFormat::Bgrx,
    VideoFormat::Nv12,
    VideoFormat::I420,
    VideoFormat::Bgr,
    VideoFormat::Rgba,
    VideoFormat::Bgra,
    VideoFormat::Xrgb,
];

/// How the pixels of a stream lie in its buffers, and memory for a frame in red, green and blue.
#[derive(Debug)]
pub struct Pixels {
    layout: Layout,
    width: usize,
    height: usize,
    strides: Vec<i32>,
    /// The frame in three bytes a pixel, where it is not that itself.
    rgb: Vec<u8>,
    /// The same as it was read, where only the difference is written.
    planes: yuv::Memory,
}

#[derive(Clone, Copy, Debug)]
enum Layout {
    Rgb,
    /// So many bytes a pixel, and where red, green and blue are in them. What else is there stays.
    Packed {
        bytes: usize,
        at: [usize; 3],
    },
    /// Luma for each pixel, chroma for four.
    Yuv {
        colours: Colours,
        chroma: Chroma,
    },
}

impl Pixels {
    /// For frames of these caps; none for a format that is not in [`FORMATS`].
    #[must_use]
    pub fn new(info: &VideoInfo) -> Option<Self> {
        let packed = |bytes, at| Some(Layout::Packed { bytes, at });
        let yuv = |chroma| Some(Layout::Yuv { colours: Colours::of(info)?, chroma });
        let layout = match info.format() {
            VideoFormat::Rgb => Some(Layout::Rgb),
            VideoFormat::Bgr => packed(3, [2, 1, 0]),
            VideoFormat::Rgbx | VideoFormat::Rgba => packed(4, [0, 1, 2]),
            VideoFormat::Bgrx | VideoFormat::Bgra => packed(4, [2, 1, 0]),
            VideoFormat::Xrgb => packed(4, [1, 2, 3]),
            VideoFormat::Nv12 => yuv(Chroma::Interleaved),
            VideoFormat::I420 => yuv(Chroma::Planar),
            _ => None,
        }?;
        Some(Self {
            layout,
            width: usize::try_from(info.width()).ok()?,
            height: usize::try_from(info.height()).ok()?,
            strides: Vec::new(),
            rgb: Vec::new(),
            planes: yuv::Memory::default(),
        })
    }

    /// Changes a frame as an image of red, green and blue.
    ///
    /// Of luma and chroma, what changes is the difference that `change` made: a frame that it leaves alone keeps every bit.
    ///
    /// # Errors
    ///
    /// [`ImageError`] where the buffer is shorter than its caps say, or what `change` says; the frame is then unchanged.
    pub fn change<R>(
        &mut self,
        frame: &mut VideoFrameRef<&mut gst::BufferRef>,
        change: impl FnOnce(ImageMut<'_, u8>) -> Result<R, ImageError>,
    ) -> Result<R, ImageError> {
        let Self { layout, width, height, strides, rgb, planes: memory } = self;
        let (width, height) = (*width, *height);
        strides.clear();
        strides.extend_from_slice(frame.plane_stride());
        // Rows that run upwards have strides below 0: too short for a row, and refused as such.
        let stride =
            |plane: usize| strides.get(plane).and_then(|&stride| usize::try_from(stride).ok()).unwrap_or(0);
        let [first, second, third, _] = frame.planes_data_mut();
        if !matches!(layout, Layout::Rgb) {
            rgb.resize(3 * width * height, 0);
        }
        match layout {
            Layout::Rgb => change(ImageMut::with_stride(width, height, stride(0), first)?),
            Layout::Packed { bytes, at } => {
                check(first, stride(0), *bytes * width, height)?;
                for (row, rgb) in first.chunks(stride(0)).zip(rgb.chunks_exact_mut(3 * width)) {
                    unpack(row, *bytes, *at, rgb);
                }
                let result = change(ImageMut::new(width, height, rgb)?)?;
                for (row, rgb) in first.chunks_mut(stride(0)).zip(rgb.chunks_exact(3 * width)) {
                    pack(rgb, *bytes, *at, row);
                }
                Ok(result)
            }
            Layout::Yuv { colours, chroma } => {
                let (columns, rows) = (width.div_ceil(2), height.div_ceil(2));
                check(first, stride(0), width, height)?;
                match chroma {
                    Chroma::Interleaved => check(second, stride(1), 2 * columns, rows)?,
                    Chroma::Planar => {
                        check(second, stride(1), columns, rows)?;
                        check(third, stride(2), columns, rows)?;
                    }
                }
                let mut planes = yuv::Planes {
                    luma: (first, stride(0)),
                    chroma: [(second, stride(1)), (third, stride(2))],
                    layout: *chroma,
                };
                planes.read(colours, width, memory, rgb);
                let result = change(ImageMut::new(width, height, rgb)?)?;
                planes.write(colours, width, memory, rgb);
                Ok(result)
            }
        }
    }
}

/// Whether a plane has so many rows of so many bytes.
fn check(plane: &[u8], stride: usize, row: usize, rows: usize) -> Result<(), ImageError> {
    let expected = (rows - 1) * stride + row;
    if stride < row {
        return Err(ImageError::Stride { width: row, stride });
    }
    if plane.len() < expected {
        return Err(ImageError::Buffer { width: row, height: rows, expected, found: plane.len() });
    }
    Ok(())
}

/// Red, green and blue of the pixels of a row.
fn unpack(row: &[u8], bytes: usize, at: [usize; 3], rgb: &mut [u8]) {
    fn of<const N: usize>(row: &[u8], at: [usize; 3], rgb: &mut [u8]) {
        for (rgb, pixel) in rgb.as_chunks_mut().0.iter_mut().zip(row.as_chunks::<N>().0) {
            *rgb = at.map(|at| pixel[at]);
        }
    }
    if bytes == 3 { of::<3>(row, at, rgb) } else { of::<4>(row, at, rgb) }
}

/// The reverse of [`unpack`].
fn pack(rgb: &[u8], bytes: usize, at: [usize; 3], row: &mut [u8]) {
    fn of<const N: usize>(rgb: &[u8], at: [usize; 3], row: &mut [u8]) {
        for (rgb, pixel) in rgb.as_chunks::<3>().0.iter().zip(row.as_chunks_mut::<N>().0) {
            (0..3).for_each(|c| pixel[at[c]] = rgb[c]);
        }
    }
    if bytes == 3 { of::<3>(rgb, at, row) } else { of::<4>(rgb, at, row) }
}
