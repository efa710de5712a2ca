//! The sheet: cells in rows, each with a title, an image or chart, and a caption.

use anyhow::{Result, anyhow};
use aquafuse::image::Image;
use plotters::coord::Shift;
use plotters::prelude::{
    BitMapBackend, BitMapElement, Color, DrawingArea, FontStyle, IntoDrawingArea, IntoFont, RGBColor,
    Rectangle, ShapeStyle, TextStyle,
};
use plotters::style::register_font;

const COLUMNS: u32 = 4;
const ROWS: u32 = 3;
/// Height of the heading, and size of a cell.
const HEAD: u32 = 48;
const CELL: (u32, u32) = (416, 376);
/// Space around what a cell holds.
const MARGIN: i32 = 12;
/// The largest image that a cell holds, and where it begins.
pub(super) const ROOM: (u32, u32) = (392, 294);
const TOP: i32 = 30;
/// From an image to its caption, and from one line of text to the next.
const GAP: i32 = 6;
const LINE: i32 = 18;
/// Size of a patch of colour.
const SWATCH: (i32, i32) = (64, 30);

const FONT: &str = "DejaVu Sans";
pub(super) const INK: RGBColor = RGBColor(38, 42, 46);
const PAPER: RGBColor = RGBColor(252, 252, 250);

pub(super) type Area<'a> = DrawingArea<BitMapBackend<'a>, Shift>;

pub(super) struct Sheet<'a>(Area<'a>);

pub(super) struct Cell<'a> {
    pub(super) area: Area<'a>,
    /// Where captions begin.
    caption: i32,
}

/// The cells of a sheet that are still empty.
pub(super) struct Cells<'a> {
    empty: std::vec::IntoIter<Area<'a>>,
    caption: i32,
}

/// Text of this size, in pixels from the top of the highest letter to the foot of the lowest.
pub(super) fn font(size: u32, colour: RGBColor) -> TextStyle<'static> {
    (FONT, size).into_font().color(&colour)
}

impl Sheet<'_> {
    /// A sheet with this heading, filled by `fill`.
    pub(super) fn draw(heading: &str, fill: impl FnOnce(&Sheet<'_>) -> Result<()>) -> Result<Image<u8>> {
        register_font(FONT, FontStyle::Normal, dejavu::sans::regular())
            .map_err(|_| anyhow!("the font of this program cannot be read"))?;
        let (width, height) = (COLUMNS * CELL.0, HEAD + ROWS * CELL.1);
        let mut samples = vec![0; 3 * (width * height) as usize];
        {
            let sheet = Sheet(BitMapBackend::with_buffer(&mut samples, (width, height)).into_drawing_area());
            sheet.0.fill(&PAPER)?;
            write(&sheet.0, heading, (MARGIN, 14), (26, INK), width as i32 - 2 * MARGIN, 1)?;
            fill(&sheet)?;
            sheet.0.present()?;
        }
        Ok(Image::from_raw(width as usize, height as usize, samples)?)
    }
}

impl<'a> Sheet<'a> {
    /// Its cells, for images of this height.
    pub(super) fn cells(&self, height: usize) -> Cells<'a> {
        let (_, below) = self.0.split_vertically(HEAD);
        let empty = below.split_evenly((ROWS as usize, COLUMNS as usize)).into_iter();
        Cells { empty, caption: TOP + height as i32 + GAP }
    }
}

impl<'a> Cells<'a> {
    /// The next cell, row by row.
    pub(super) fn next(&mut self, title: &str) -> Result<Cell<'a>> {
        let area = self.empty.next().ok_or_else(|| anyhow!("the sheet has no more than {ROWS} rows"))?;
        let cell = Cell { area, caption: self.caption };
        write(&cell.area, title, (MARGIN, 6), (18, INK), ROOM.0 as i32, 1)?;
        Ok(cell)
    }
}

impl<'a> Cell<'a> {
    /// Where a chart goes: below the title, to the end of the cell.
    pub(super) fn room(&self) -> Area<'a> {
        self.area.margin(TOP, LINE + MARGIN + 4, 4, MARGIN)
    }

    /// An image, which is to fit into [`ROOM`], below the title.
    pub(super) fn image(&self, image: &Image<u8>) -> Result<()> {
        let (width, height) = (image.width() as u32, image.height() as u32);
        let corner = (MARGIN + (ROOM.0 - width) as i32 / 2, TOP);
        let image_file: Option<BitMapElement<'_, _>> =
            BitMapElement::with_ref(corner, (width, height), image.as_raw());
        Ok(self.area.draw(&image_file.ok_or_else(|| anyhow!("an image of another size than it says"))?)?)
    }

    /// What is to be seen, in at most two lines below the image.
    pub(super) fn caption(&self, text: &str) -> Result<()> {
        write(&self.area, text, (MARGIN, self.caption), (15, INK), ROOM.0 as i32, 2)
    }

    /// The same on the right of a patch of colour.
    pub(super) fn caption_beside(&self, text: &str) -> Result<()> {
        let right_of = SWATCH.0 + 10;
        write(&self.area, text, (MARGIN + right_of, self.caption), (15, INK), ROOM.0 as i32 - right_of, 2)
    }

    /// One line at the foot of the cell, below a chart.
    pub(super) fn foot(&self, text: &str) -> Result<()> {
        write(&self.area, text, (MARGIN, TOP + ROOM.1 as i32 + GAP + LINE), (15, INK), ROOM.0 as i32, 1)
    }

    /// A patch of colour below the image.
    pub(super) fn swatch(&self, [r, g, b]: [u8; 3]) -> Result<()> {
        let corner = (MARGIN, self.caption + 1);
        let opposite = (corner.0 + SWATCH.0, corner.1 + SWATCH.1);
        self.area.draw(&Rectangle::new([corner, opposite], RGBColor(r, g, b).filled()))?;
        Ok(self.area.draw(&Rectangle::new([corner, opposite], INK))?)
    }

    /// From black to white, and what either end means.
    pub(super) fn bar(&self, black: &str, white: &str) -> Result<()> {
        let steps = ROOM.0 as i32;
        for x in 0..steps {
            let grey = (255 * x / (steps - 1)) as u8;
            let column = [(MARGIN + x, self.caption), (MARGIN + x + 1, self.caption + 10)];
            let style = ShapeStyle::from(&RGBColor(grey, grey, grey)).filled();
            self.area.draw(&Rectangle::new(column, style))?;
        }
        let frame = [(MARGIN, self.caption), (MARGIN + steps, self.caption + 10)];
        self.area.draw(&Rectangle::new(frame, INK))?;
        let style = font(15, INK);
        let (width, _) = self.area.estimate_text_size(white, &style)?;
        self.area.draw_text(black, &style, (MARGIN, self.caption + 14))?;
        Ok(self.area.draw_text(white, &style, (MARGIN + steps - width as i32, self.caption + 14))?)
    }
}

/// Writes text in at most `lines` lines of `width`; what does not fit is cut off and marked with dots.
pub(super) fn write(
    area: &Area<'_>,
    text: &str,
    (x, y): (i32, i32),
    (size, colour): (u32, RGBColor),
    width: i32,
    lines: usize,
) -> Result<()> {
    let style = font(size, colour);
    let fits = |text: &str| -> Result<bool> { Ok(area.estimate_text_size(text, &style)?.0 as i32 <= width) };
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
        area.draw_text(&format!("{written}{dots}"), &style, (x, y + line as i32 * LINE))?;
    }
    Ok(())
}
