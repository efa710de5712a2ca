//! The sheet of an image's estimates: panels in rows, each with a title, an image or chart, and a caption.

use aquafuse::image::Image;
use plotters::prelude::{Color, RGBColor, Rectangle, ShapeStyle};

use crate::drawing::DrawError;
use crate::drawing::canvas::{INK, LINE, Pixels, bitmap, font, put, write};

const COLUMNS: u32 = 4;
const ROWS: u32 = 3;
/// Height of the heading, and size of a panel.
const HEAD: u32 = 48;
const PANEL: (u32, u32) = (416, 376);
/// Space around what a panel holds.
const MARGIN: i32 = 12;
/// The largest image that a panel holds, and where it begins.
pub(super) const ROOM: (u32, u32) = (392, 294);
const TOP: i32 = 30;
/// From an image to its caption.
const GAP: i32 = 6;
/// Size of a patch of colour.
const SWATCH: (i32, i32) = (64, 30);

pub(super) struct Sheet<'a>(Pixels<'a>);

pub(super) struct Panel<'a> {
    pub(super) area: Pixels<'a>,
    /// Where captions begin.
    caption: i32,
}

/// The panels of a sheet that are still empty.
pub(super) struct Panels<'a> {
    empty: std::vec::IntoIter<Pixels<'a>>,
    caption: i32,
}

impl Sheet<'_> {
    /// A sheet with this heading, filled by `fill`.
    pub(super) fn draw(
        heading: &str,
        fill: impl FnOnce(&Sheet<'_>) -> Result<(), DrawError>,
    ) -> Result<Image<u8>, DrawError> {
        let (width, height) = (COLUMNS * PANEL.0, HEAD + ROWS * PANEL.1);
        bitmap((width, height), |area| {
            write(area, heading, (MARGIN, 14), &font(26, INK), width as i32 - 2 * MARGIN, 1)?;
            fill(&Sheet(area.clone()))
        })
    }
}

impl<'a> Sheet<'a> {
    /// Its panels, for images of this height.
    pub(super) fn panels(&self, height: usize) -> Panels<'a> {
        let (_, below) = self.0.split_vertically(HEAD);
        let empty = below.split_evenly((ROWS as usize, COLUMNS as usize)).into_iter();
        Panels { empty, caption: TOP + height as i32 + GAP }
    }
}

impl<'a> Panels<'a> {
    /// The next panel, row by row.
    pub(super) fn next(&mut self, title: &str) -> Result<Panel<'a>, DrawError> {
        let area = self.empty.next().expect("a panel for each figure");
        let panel = Panel { area, caption: self.caption };
        write(&panel.area, title, (MARGIN, 6), &font(18, INK), ROOM.0 as i32, 1)?;
        Ok(panel)
    }
}

impl<'a> Panel<'a> {
    /// Where a chart goes: below the title, to the end of the panel.
    pub(super) fn room(&self) -> Pixels<'a> {
        self.area.margin(TOP, LINE + MARGIN + 4, 4, MARGIN)
    }

    /// An image, which is to fit into [`ROOM`], below the title.
    pub(super) fn image(&self, image: &Image<u8>) -> Result<(), DrawError> {
        let corner = (MARGIN + (ROOM.0 - image.width() as u32) as i32 / 2, TOP);
        put(&self.area, corner, image)
    }

    /// What is to be seen, in at most two lines below the image.
    pub(super) fn caption(&self, text: &str) -> Result<(), DrawError> {
        write(&self.area, text, (MARGIN, self.caption), &font(15, INK), ROOM.0 as i32, 2)
    }

    /// The same on the right of a patch of colour.
    pub(super) fn caption_beside(&self, text: &str) -> Result<(), DrawError> {
        let right_of = SWATCH.0 + 10;
        write(
            &self.area,
            text,
            (MARGIN + right_of, self.caption),
            &font(15, INK),
            ROOM.0 as i32 - right_of,
            2,
        )
    }

    /// One line at the foot of the panel, below a chart.
    pub(super) fn foot(&self, text: &str) -> Result<(), DrawError> {
        write(&self.area, text, (MARGIN, TOP + ROOM.1 as i32 + GAP + LINE), &font(15, INK), ROOM.0 as i32, 1)
    }

    /// A patch of colour below the image.
    pub(super) fn swatch(&self, [r, g, b]: [u8; 3]) -> Result<(), DrawError> {
        let corner = (MARGIN, self.caption + 1);
        let opposite = (corner.0 + SWATCH.0, corner.1 + SWATCH.1);
        self.area.draw(&Rectangle::new([corner, opposite], RGBColor(r, g, b).filled()))?;
        Ok(self.area.draw(&Rectangle::new([corner, opposite], INK))?)
    }

    /// From black to white, and what either end means.
    pub(super) fn bar(&self, black: &str, white: &str) -> Result<(), DrawError> {
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
        self.area.draw_text(black, &style, (MARGIN, self.caption + 16))?;
        Ok(self.area.draw_text(white, &style, (MARGIN + steps - width as i32, self.caption + 16))?)
    }
}
