//! Images side by side with captions, to look at.

use std::borrow::Cow;

use ::image::imageops::{FilterType, resize};
use ::image::{ImageBuffer, Rgb};
use aquafuse::image::Image;
use plotters::prelude::{Color, PathElement, RGBColor};

use super::DrawError;
use super::canvas::{INK, Pixels, bitmap, font, put, write};

/// An image with a caption, or an empty place with a word on it.
#[derive(Clone, Debug)]
pub struct Cell {
    /// One line; what is longer than the image is wide is cut off.
    pub caption: String,
    /// The image; none leaves the place empty.
    pub image: Option<Image<u8>>,
}

const GAP: u32 = 8;
const CAPTION: u32 = 22;
/// The colour of outlines, which no water has.
const OUTLINE: RGBColor = RGBColor(255, 225, 40);

/// Lays rows of cells out, every image scaled to fit `width` x `height`.
///
/// # Errors
///
/// [`DrawError`] when the text cannot be drawn.
pub fn contact_sheet(rows: &[Vec<Cell>], width: u32, height: u32) -> Result<Image<u8>, DrawError> {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0) as u32;
    let (step_x, step_y) = (width + GAP, height + CAPTION + GAP);
    let size = (GAP + columns * step_x, GAP + rows.len() as u32 * step_y);
    bitmap(size, |sheet| {
        for (row, y) in rows.iter().zip((GAP..).step_by(step_y as usize)) {
            for (cell, x) in row.iter().zip((GAP..).step_by(step_x as usize)) {
                let (size, top) = match cell.image {
                    Some(_) => (15, y + height + 5),
                    None => (19, y + height / 2 - 10),
                };
                let style = font(size, INK);
                write(sheet, &cell.caption, (x as i32 + 1, top as i32), &style, width as i32, 1)?;
                if let Some(image) = &cell.image {
                    put_scaled(sheet, image, [x, y], [width, height])?;
                }
            }
        }
        Ok(())
    })
}

/// Draws `image` at `corner`, as large as fits into `room`, centred.
fn put_scaled(
    sheet: &Pixels<'_>,
    image: &Image<u8>,
    corner: [u32; 2],
    room: [u32; 2],
) -> Result<(), DrawError> {
    let scaled = scaled(image, room)?;
    let fitted = [scaled.width() as u32, scaled.height() as u32];
    let at = |i: usize| (corner[i] + room[i].saturating_sub(fitted[i]) / 2) as i32;
    put(sheet, (at(0), at(1)), &scaled)
}

/// The image as large as it fits into `room`.
fn scaled(image: &Image<u8>, room: [u32; 2]) -> Result<Cow<'_, Image<u8>>, DrawError> {
    let (width, height) = (image.width() as u32, image.height() as u32);
    let scale = (f64::from(room[0]) / f64::from(width)).min(f64::from(room[1]) / f64::from(height));
    let fitted = [width, height].map(|side| ((f64::from(side) * scale).round() as u32).max(1));
    if fitted == [width, height] {
        return Ok(Cow::Borrowed(image));
    }
    let large = ImageBuffer::<Rgb<u8>, &[u8]>::from_raw(width, height, image.as_raw());
    let small = resize(&large.expect("three samples a pixel"), fitted[0], fitted[1], FilterType::CatmullRom)
        .into_raw();
    Ok(Cow::Owned(Image::from_raw(fitted[0] as usize, fitted[1] as usize, small)?))
}

/// The image as large as it fits into `room`, with outlines in shares of its sides.
pub(crate) fn outlined(
    image: &Image<u8>,
    room: [u32; 2],
    outlines: &[Vec<[f64; 2]>],
) -> Result<Image<u8>, DrawError> {
    let scaled = scaled(image, room)?;
    let size = (scaled.width() as u32, scaled.height() as u32);
    let pixel =
        |share: f64, side: u32| (share * f64::from(side)).round().clamp(0.0, f64::from(side - 1)) as i32;
    bitmap(size, |area| {
        put(area, (0, 0), &scaled)?;
        for outline in outlines {
            // A dark line beneath a bright one is seen on any water.
            for (colour, width) in [(INK, 3), (OUTLINE, 1)] {
                let corners: Vec<(i32, i32)> =
                    outline.iter().map(|&[x, y]| (pixel(x, size.0), pixel(y, size.1))).collect();
                area.draw(&PathElement::new(corners, colour.stroke_width(width)))?;
            }
        }
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sheet_holds_its_rows_and_columns() {
        let image = Image::<u8>::from_raw(4, 2, vec![0; 24]).unwrap();
        let cell = Cell { caption: "black".into(), image: Some(image) };
        let sheet = contact_sheet(&[vec![cell.clone(), cell.clone()], vec![cell]], 40, 20).unwrap();
        assert_eq!(sheet.size(), (8 + 2 * 48, 8 + 2 * 50));
        assert_eq!(sheet.pixels()[10 * sheet.width() + 10], [0; 3]);
    }

    #[test]
    fn an_outline_is_drawn_where_it_is_in_the_image_whatever_its_size() {
        let image = Image::<u8>::from_raw(80, 40, vec![0; 9_600]).unwrap();
        let square = vec![[0.25, 0.25], [0.75, 0.25], [0.75, 0.75], [0.25, 0.75], [0.25, 0.25]];
        let drawn = outlined(&image, [40, 40], &[square]).unwrap();
        assert_eq!(drawn.size(), (40, 20));
        let at = |x: usize, y: usize| drawn.pixels()[y * 40 + x];
        for (x, y) in [(10, 5), (30, 5), (20, 5), (10, 10), (30, 15)] {
            assert!(at(x, y)[0] > 200 && at(x, y)[2] < 80, "{x}, {y}: {:?}", at(x, y));
        }
        assert_eq!((at(20, 10), at(2, 2)), ([0; 3], [0; 3]));
    }

    /// A caption is drawn, in its own cell alone, whatever its length.
    #[test]
    fn a_long_caption_stays_below_its_image() {
        let image = Image::<u8>::from_raw(4, 2, vec![200; 24]).unwrap();
        let cell = |caption: &str| Cell { caption: caption.into(), image: Some(image.clone()) };
        let drawn = |first: &str| contact_sheet(&[vec![cell(first), cell("β_B")]], 100, 50).unwrap();
        let (short, long) = (drawn("B∞"), drawn("a caption that is much longer than its image is wide"));
        let half = |sheet: &Image<u8>, right: bool| -> Vec<[u8; 3]> {
            let (width, edge) = (sheet.width(), 8 + 100 + 4);
            let rows = sheet.pixels().chunks(width).map(|row| row.split_at(edge));
            rows.flat_map(|(a, b)| if right { b.to_vec() } else { a.to_vec() }).collect()
        };
        assert_eq!(half(&short, true), half(&long, true));
        assert_ne!(half(&short, false), half(&long, false));
    }
}
