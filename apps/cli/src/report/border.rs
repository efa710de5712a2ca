//! What surrounds a scene, as it is reported.

use aquafuse::scene_area::{Margins, SceneArea};
use serde::Serialize;

/// For programs.
#[derive(Serialize)]
pub(crate) struct BorderRecord {
    /// Rows and columns at the sides of the stored image that show nothing of the scene.
    #[serde(flatten)]
    margins: Margins,
    /// Whether pixels within the margins are left out too: around the circle of a fish-eye, or transparent ones.
    outline: bool,
    /// How much of the image is scene.
    scene: f64,
}

impl BorderRecord {
    pub(crate) fn of(area: &SceneArea) -> Self {
        Self { margins: area.margins(), outline: area.has_outline(), scene: area.share() }
    }
}

/// For people.
pub(crate) fn words(area: &SceneArea) -> String {
    let outline = if area.has_outline() { ", and an outline within them" } else { "" };
    let Margins { top, right, bottom, left } = area.margins();
    format!(
        "{top},{right},{bottom},{left} pixels (top, right, bottom, left){outline}; {:.1} % is scene",
        100.0 * area.share()
    )
}
