//! Images side by side with captions, to look at.

use ::image::imageops::{FilterType, resize};
use ::image::{ImageBuffer, Rgb};
use aquafuse::image::Image;

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
    let (width, height) = (image.width() as u32, image.height() as u32);
    let scale = (f64::from(room[0]) / f64::from(width)).min(f64::from(room[1]) / f64::from(height));
    let fitted = [width, height].map(|side| ((f64::from(side) * scale).round() as u32).max(1));
    let at = |i: usize| (corner[i] + room[i].saturating_sub(fitted[i]) / 2) as i32;
    let place = (at(0), at(1));
    if fitted == [width, height] {
        return put(sheet, place, image);
    }
    let large = ImageBuffer::<Rgb<u8>, &[u8]>::from_raw(width, height, image.as_raw());
    let small = resize(&large.expect("three samples a pixel"), fitted[0], fitted[1], FilterType::CatmullRom)
        .into_raw();
    put(sheet, place, &Image::from_raw(fitted[0] as usize, fitted[1] as usize, small)?)
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
