//! What is drawn on, the font, and text in lines.

use std::sync::LazyLock;

use aquafuse::image::Image;
use plotters::coord::Shift;
use plotters::prelude::{
    BitMapBackend, BitMapElement, DrawingArea, DrawingBackend, FontStyle, IntoDrawingArea, IntoFont,
    RGBColor, SVGBackend, TextStyle,
};
use plotters::style::register_font;

use super::DrawError;

pub(super) const INK: RGBColor = RGBColor(38, 42, 46);
pub(super) const PAPER: RGBColor = RGBColor(252, 252, 250);

const FONT: &str = "DejaVu Sans";
/// From one line of text to the next, in pixels.
pub(super) const LINE: i32 = 18;

pub(super) type Area<B> = DrawingArea<B, Shift>;
/// An area of an image.
pub(super) type Pixels<'a> = Area<BitMapBackend<'a>>;

/// Text of this size, in pixels from the top of the highest letter to the foot of the lowest.
pub(super) fn font(size: u32, colour: RGBColor) -> TextStyle<'static> {
    (FONT, size).into_font().color(&colour)
}

/// Plotters keeps fonts by name for the whole program: one registration serves every thread.
fn with_font() -> Result<(), DrawError> {
    static REGISTERED: LazyLock<bool> =
        LazyLock::new(|| register_font(FONT, FontStyle::Normal, dejavu::sans::regular()).is_ok());
    REGISTERED.then_some(()).ok_or_else(|| DrawError("the built-in font cannot be read".into()))
}

/// An image of this size, drawn by `draw`.
pub(super) fn bitmap(
    (width, height): (u32, u32),
    draw: impl FnOnce(&Pixels<'_>) -> Result<(), DrawError>,
) -> Result<Image<u8>, DrawError> {
    with_font()?;
    let mut samples = vec![0; 3 * width as usize * height as usize];
    {
        let area = BitMapBackend::with_buffer(&mut samples, (width, height)).into_drawing_area();
        area.fill(&PAPER)?;
        draw(&area)?;
        area.present()?;
    }
    Ok(Image::from_raw(width as usize, height as usize, samples)?)
}

/// An SVG of this size within a page of HTML, drawn by `draw` on whatever the page's colour is. Its text stays text.
pub(super) fn svg(
    size: (u32, u32),
    draw: impl FnOnce(&Area<SVGBackend<'_>>) -> Result<(), DrawError>,
) -> Result<String, DrawError> {
    with_font()?;
    let mut text = String::new();
    {
        let area = SVGBackend::with_string(&mut text, size).into_drawing_area();
        draw(&area)?;
        area.present()?;
    }
    // HTML knows the element by its name; without the address it is plain that a page asks for nothing.
    Ok(text.replacen(" xmlns=\"http://www.w3.org/2000/svg\"", "", 1))
}

/// Puts an image onto the area, pixel for pixel.
pub(super) fn put(area: &Pixels<'_>, corner: (i32, i32), image: &Image<u8>) -> Result<(), DrawError> {
    let size = (image.width() as u32, image.height() as u32);
    let element: Option<BitMapElement<'_, _>> = BitMapElement::with_ref(corner, size, image.as_raw());
    Ok(area.draw(&element.expect("three samples a pixel"))?)
}

/// Writes text in at most `lines` lines of `width`; what does not fit is cut off and marked with dots.
pub(super) fn write<B: DrawingBackend>(
    area: &Area<B>,
    text: &str,
    (x, y): (i32, i32),
    style: &TextStyle<'_>,
    width: i32,
    lines: usize,
) -> Result<(), DrawError> {
    let fits = |text: &str| -> Result<bool, DrawError> {
        Ok(area.estimate_text_size(text, style)?.0 as i32 <= width)
    };
    let mut words = text.split(' ').peekable();
    for line in 0..lines {
        let mut written = String::new();
        while let Some(word) = words.peek() {
            let longer = if written.is_empty() { (*word).to_owned() } else { format!("{written} {word}") };
            if !written.is_empty() && !fits(&longer)? {
                break;
            }
            written = longer;
            words.next();
        }
        let last = line + 1 == lines;
        let whole = fits(&written)? && !(last && words.peek().is_some());
        while !whole && !fits(&format!("{written} …"))? && written.pop().is_some() {}
        let dots = if whole { "" } else { " …" };
        area.draw_text(&format!("{written}{dots}"), style, (x, y + line as i32 * LINE))?;
    }
    Ok(())
}
