//! A trained scene as one HTML page, which needs nothing else: it renders by WebGL 2.

use aquafuse_data::files::display;
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use serde_json::{Value, json};
use std::path::Path;

use crate::around::Around;
use crate::camera::Camera;
use crate::medium::Medium;
use crate::model::Model;
use crate::splats::Splats;

/// The page with its placeholders, and its scripts.
const PAGE: &str = include_str!("page/page.html");
const VIEWER: &str = include_str!("page/viewer.js");
const CONTROLS: &str = include_str!("page/controls.js");

/// The page of a model that is called `name`, with the named cameras to look from; `None` if they have no common direction.
///
/// View dependence is left out: the page renders the harmonic of degree 0.
pub fn page(name: &Path, model: &Model, cameras: &[(String, Camera)]) -> Option<String> {
    let Model { splats, medium } = model;
    let all: Vec<&Camera> = cameras.iter().map(|(_, camera)| camera).collect();
    let around = Around::new(&all, splats)?;
    let scene = json!({
        "water": water(medium),
        "middle": around.centre(),
        "up": around.up(),
        "cameras": cameras.iter().map(|(name, camera)| json!({
            "name": name,
            "width": camera.width,
            "height": camera.height,
            "focal": camera.focal,
            "centre": camera.centre,
            "turn": camera.rotation,
            "shift": camera.translation,
        })).collect::<Vec<_>>(),
    });
    // No string in it may end the element that contains it.
    let scene = scene.to_string().replace('<', "\\u003c");
    Some(filled(
        PAGE,
        &[
            ("title", &escaped(&display(name).to_string())),
            ("scene", &scene),
            ("splats", &BASE64_STANDARD.encode(packed(splats))),
            ("viewer", VIEWER),
            ("controls", CONTROLS),
        ],
    ))
}

/// The splats as the page reads them, 36 bytes each, little-endian: mean and scales as floats; colour, opacity and
/// quaternion as words and bytes. Colours go up to 8: without the water, what is bright in an image is brighter than white.
fn packed(splats: &Splats<f32>) -> Vec<u8> {
    // `as` saturates.
    let word = |value: f32| (value.round() as u16).to_le_bytes();
    let mut bytes = Vec::with_capacity(36 * splats.len());
    for i in 0..splats.len() {
        let floats = splats.mean(i).into_iter().chain(splats.scale(i));
        bytes.extend(floats.flat_map(f32::to_le_bytes));
        bytes.extend(splats.colour(i).into_iter().flat_map(|value| word(8192.0 * value)));
        bytes.extend(word(65535.0 * splats.opacity(i)));
        bytes.extend(splats.rotation(i).map(|q| (127.0 * q).round() as i8 as u8));
    }
    bytes
}

/// The medium as the page reads it; null is air.
fn water(medium: &Medium<f32>) -> Value {
    let (veil, growth, curves, per_unit) = match medium {
        Medium::Air => return Value::Null,
        Medium::Learned(water) => {
            let fading = water.attenuation().map(|beta| ([beta, 0.0, 0.0, 0.0], f32::MAX));
            (water.veil(), water.backscatter(), fading, 1.0)
        }
        Medium::Known { water, per_unit } => (
            water.veiling_light.rgb(),
            water.backscatter_coefficient,
            water.attenuation.each_ref().map(|curve| (curve.mu(), curve.held_beyond())),
            *per_unit,
        ),
    };
    // From units of the water's z to units of the scene.
    json!({
        "veil": veil,
        "growth": growth.map(|beta| beta * per_unit),
        "fading": curves.map(|([a, b, c, d], _)| [a * per_unit, b * per_unit, c * per_unit, d * per_unit]),
        "held": curves.map(|(_, held)| held / per_unit),
    })
}

/// A camera that sees most of the splats, with y down, as COLMAP's cameras mostly have it.
pub fn outside(splats: &Splats<f32>) -> Camera {
    let all = |axis: usize| {
        let mut values: Vec<f64> = (0..splats.len()).map(|i| f64::from(splats.mean(i)[axis])).collect();
        values.sort_by(f64::total_cmp);
        values
    };
    let quantile = |values: &[f64], share: f64| values[((values.len() - 1) as f64 * share) as usize];
    let ranges = [0, 1, 2].map(|axis| {
        let values = all(axis);
        [quantile(&values, 0.1), quantile(&values, 0.5), quantile(&values, 0.9)]
    });
    let reach = ranges.iter().map(|[low, _, high]| high - low).fold(1e-3, f64::max);
    let [x, y, z] = ranges.map(|[_, middle, _]| middle);
    Camera {
        width: 800,
        height: 600,
        focal: [700.0; 2],
        centre: [400.0, 300.0],
        rotation: Camera::rotation_of([1.0, 0.0, 0.0, 0.0]),
        translation: [-x, -y, 2.0 * reach - z],
    }
}

/// A string with `{{name}}` replaced; what is inserted is not searched again.
fn filled(page: &str, parts: &[(&str, &str)]) -> String {
    let mut pieces = page.split("{{");
    let mut text = pieces.next().unwrap_or_default().to_owned();
    for piece in pieces {
        let (name, rest) = piece.split_once("}}").unwrap_or((piece, ""));
        text += parts.iter().find(|(known, _)| *known == name).map_or("", |(_, part)| part);
        text += rest;
    }
    text
}

/// A string with the characters escaped that HTML would interpret.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_place_of_the_page_is_filled_once() {
        let names = ["title", "scene", "splats", "viewer", "controls"];
        let parts = names.map(|name| (name, "{{title}}"));
        // The title stands twice; what is put in stays as it is.
        assert_eq!(filled(PAGE, &parts).matches("{{title}}").count(), 6);
        assert_eq!(filled("a{{b}}c{{d}}e", &[("b", "1"), ("d", "2")]), "a1c2e");
    }

    #[test]
    fn what_runs_in_the_page_does_not_end_its_element() {
        for text in [VIEWER, CONTROLS] {
            assert!(!text.contains("</"));
        }
    }

    #[test]
    fn a_splat_is_36_bytes_and_may_be_brighter_than_white() {
        let mut splats = Splats::<f32>::new(0);
        splats.push(&Splats::<f32>::ball(0, [1.0, 2.0, 3.0], 0.5, 0.5, [2.0, 0.5, -1.0]));
        let bytes = packed(&splats);
        assert_eq!(bytes.len(), 36);
        assert_eq!(bytes[4..8], 2.0_f32.to_le_bytes());
        assert_eq!(bytes[24..30], [0, 64, 0, 16, 0, 0]);
        assert_eq!(bytes[32..], [127, 0, 0, 0]);
    }

    #[test]
    fn from_outside_most_splats_are_in_view() {
        let mut splats = Splats::<f32>::new(0);
        for i in 0..100 {
            let position = [f64::from(i % 10), f64::from(i / 10), f64::from(i % 7)];
            splats.push(&Splats::<f32>::ball(0, position, 0.1, 0.9, [0.5; 3]));
        }
        let camera = outside(&splats);
        let seen = (0..splats.len()).filter(|&i| {
            let [x, y, z] = camera.to_camera(splats.mean(i).map(f64::from));
            z > 0.0 && (x / z).abs() < 400.0 / 700.0 && (y / z).abs() < 300.0 / 700.0
        });
        assert!(seen.count() > 80);
    }
}
