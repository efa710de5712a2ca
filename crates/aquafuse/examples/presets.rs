//! Prints the presets as a table: veil as a colour, coefficients per metre, and how far the fits are off.
//!
//! cargo run --release -p aquafuse --example presets -- [METRES BELOW THE SURFACE]

use aquafuse::image::Encoded;
use aquafuse::waterbody::presets::{Conditions, Preset};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut conditions = Conditions::default();
    if let Some(metres) = std::env::args().nth(1) {
        conditions = conditions.with_depth_below_surface(metres.parse()?)?;
    }
    println!("| preset | veil | β_B of R, G, B | β_D at 0 m | β_D at 5 m | off: B | direct | seen |");
    println!("|---|---|---|---|---|---|---|---|");
    for &preset in Preset::ALL {
        let derived = preset.derive::<Encoded>(&conditions);
        let water = &derived.water;
        let [r, g, b] = water.veiling_light.rgb().map(|value| (255.0 * value).round() as u8);
        let attenuation = |z: f32| triple(water.attenuation.map(|curve| curve.coefficient(z)));
        let worst = |of: [f32; 3]| of.into_iter().fold(0.0, f32::max);
        println!(
            "| {} | #{r:02x}{g:02x}{b:02x} | {} | {} | {} | {:.3} | {:.3} | {:.3} |",
            preset.name(),
            triple(water.backscatter_coefficient),
            attenuation(0.0),
            attenuation(5.0),
            worst(derived.residual.backscatter),
            worst(derived.residual.direct),
            worst(derived.residual.seen),
        );
    }
    Ok(())
}

fn triple([r, g, b]: [f32; 3]) -> String {
    format!("{r:.3}, {g:.3}, {b:.3}")
}
