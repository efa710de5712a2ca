//! Images side by side with captions, to look at.

use ::image::imageops::{FilterType, replace, resize};
use ::image::{Rgb, RgbImage};
use aquafuse::image::Image;
use embedded_graphics::Drawable;
use embedded_graphics::draw_target::DrawTarget;
use embedded_graphics::geometry::{OriginDimensions, Point, Size};
use embedded_graphics::mono_font::{MonoTextStyle, ascii::FONT_9X15, ascii::FONT_9X15_BOLD};
use embedded_graphics::pixelcolor::{Rgb888, RgbColor};
use embedded_graphics::text::{Baseline, Text};

/// An image with a caption, or an empty place with a word on it.
#[derive(Clone, Debug)]
pub struct Cell {
    /// Captions are ASCII, about one character a 9 pixels of width.
    pub caption: String,
    /// The image; none leaves the place empty.
    pub image: Option<Image<u8>>,
}

const PAPER: Rgb<u8> = Rgb([250, 250, 248]);
const GAP: u32 = 8;
const CAPTION: u32 = 22;

/// Lays rows of cells out, every image scaled to fit `width` x `height`.
pub fn lay_out(rows: &[Vec<Cell>], width: u32, height: u32) -> Image<u8> {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0) as u32;
    let (step_x, step_y) = (width + GAP, height + CAPTION + GAP);
    let size = (GAP + columns * step_x, GAP + rows.len() as u32 * step_y);
    let mut sheet = Canvas(RgbImage::from_pixel(size.0.max(1), size.1.max(1), PAPER));
    for (row, y) in rows.iter().zip((GAP..).step_by(step_y as usize)) {
        for (cell, x) in row.iter().zip((GAP..).step_by(step_x as usize)) {
            let (font, baseline) = match cell.image {
                Some(_) => (&FONT_9X15, y + height + 3),
                None => (&FONT_9X15_BOLD, y + height / 2 - 15),
            };
            let style = MonoTextStyle::new(font, Rgb888::new(40, 44, 48));
            let place = Point::new(x as i32 + 1, baseline as i32);
            let Ok(_) = Text::with_baseline(&cell.caption, place, style, Baseline::Top).draw(&mut sheet);
            if let Some(image) = &cell.image {
                place_scaled(&mut sheet.0, image, [x, y], [width, height]);
            }
        }
    }
    let (width, height) = (sheet.0.width() as usize, sheet.0.height() as usize);
    Image::from_raw(width, height, sheet.0.into_raw()).expect("a sheet has pixels")
}

/// Draws `image` at `corner`, as large as fits into `room`, centred.
fn place_scaled(sheet: &mut RgbImage, image: &Image<u8>, corner: [u32; 2], room: [u32; 2]) {
    let (width, height) = (image.width() as u32, image.height() as u32);
    let Some(image_file) = RgbImage::from_raw(width, height, image.as_raw().to_vec()) else { return };
    let scale = (f64::from(room[0]) / f64::from(width)).min(f64::from(room[1]) / f64::from(height));
    let fitted = [width, height].map(|side| ((f64::from(side) * scale).round() as u32).max(1));
    let scaled = match fitted == [width, height] {
        true => image_file,
        false => resize(&image_file, fitted[0], fitted[1], FilterType::CatmullRom),
    };
    let at = |i: usize| i64::from(corner[i] + (room[i].saturating_sub(fitted[i])) / 2);
    replace(sheet, &scaled, at(0), at(1));
}

/// An image that text can be drawn on.
struct Canvas(RgbImage);

impl OriginDimensions for Canvas {
    fn size(&self) -> Size {
        Size::new(self.0.width(), self.0.height())
    }
}

impl DrawTarget for Canvas {
    type Color = Rgb888;
    type Error = std::convert::Infallible;

    fn draw_iter<I>(&mut self, pixels: I) -> Result<(), Self::Error>
    where
        I: IntoIterator<Item = embedded_graphics::Pixel<Rgb888>>,
    {
        for embedded_graphics::Pixel(at, colour) in pixels {
            if let (Ok(x), Ok(y)) = (u32::try_from(at.x), u32::try_from(at.y))
                && let Some(pixel) = self.0.get_pixel_mut_checked(x, y)
            {
                *pixel = Rgb([colour.r(), colour.g(), colour.b()]);
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sheet_holds_its_rows_and_columns() {
        let image = Image::<u8>::from_raw(4, 2, vec![0; 24]).unwrap();
        let cell = Cell { caption: "black".into(), image: Some(image) };
        let sheet = lay_out(&[vec![cell.clone(), cell.clone()], vec![cell]], 40, 20);
        assert_eq!(sheet.size(), (8 + 2 * 48, 8 + 2 * 50));
        assert_eq!(sheet.pixels()[10 * sheet.width() + 10], [0; 3]);
    }
}
