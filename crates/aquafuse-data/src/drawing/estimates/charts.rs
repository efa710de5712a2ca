//! Samples and fitted curves over depth, one colour a channel.

use aquafuse::waterbody::{DepthBin, DepthFactors, Evidence, Waterbody};
use plotters::prelude::{ChartBuilder, Circle, Color, DashedLineSeries, LineSeries, RGBColor};

use super::panels::Panel;
use crate::drawing::DrawError;
use crate::drawing::canvas::{INK, font};

/// Red, green and blue as lines are seen well on paper.
pub(super) const CHANNELS: [RGBColor; 3] =
    [RGBColor(206, 44, 44), RGBColor(30, 140, 60), RGBColor(36, 88, 204)];

/// Steps of a curve over the width of a chart.
const STEPS: u16 = 160;
/// Pixels of a dash, and from one to the next.
const DASH: (i32, i32) = (6, 5);

/// The end of the longest axis.
const FARTHEST: f32 = 1e37;

pub(super) struct Charts<'a> {
    pub(super) water: &'a Waterbody,
    /// What `physical` reads in place of the curve of backscatter.
    pub(super) depth_factors: Option<&'a DepthFactors>,
    pub(super) evidence: &'a Evidence,
    pub(super) unit: &'a str,
}

#[derive(Clone, Copy, PartialEq)]
pub(super) enum Chart {
    Backscatter,
    Attenuation,
    Illumination,
}

impl Charts<'_> {
    pub(super) fn draw(&self, chart: Chart, panel: &Panel<'_>) -> Result<(), DrawError> {
        let farthest = self.evidence.bins.last().map_or(0.0, |bin| bin.z);
        // What is beyond all numbers has no axis.
        let far = (1.05 * farthest.max(self.evidence.z95)).min(FARTHEST);
        let curve = |z: f32| self.curve(chart, z);
        let z_at = |step: u16| far * f32::from(step) / f32::from(STEPS);
        let dots: Vec<(f32, [Option<f32>; 3])> =
            self.evidence.bins.iter().map(|bin| (bin.z, sample(chart, bin))).collect();
        let counted = self.depth_factors.filter(|_| chart == Chart::Backscatter);
        let counted = |z: f32| counted.map(|factors| self.counted(factors, z));
        let places = || (0..=STEPS).map(z_at);
        let highest =
            places().flat_map(curve).chain(places().filter_map(counted).flatten()).fold(0.0, f32::max);
        let top = match chart {
            Chart::Backscatter => {
                dots.iter().flat_map(|(_, of)| of.iter().flatten().copied()).fold(highest, f32::max)
            }
            // Samples at the camera are a small number divided by a small number: they must not rule.
            Chart::Attenuation => 1.5 * highest,
            Chart::Illumination => 1.0,
        };
        let top = if top > 0.0 { 1.08 * top } else { 1.0 };

        let mut axes = ChartBuilder::on(&panel.room())
            .x_label_area_size(40)
            .y_label_area_size(58)
            .margin_top(6)
            .build_cartesian_2d(0.0..far, 0.0..top)?;
        axes.configure_mesh()
            .x_labels(7)
            .y_labels(7)
            .light_line_style(INK.mix(0.0))
            .bold_line_style(INK.mix(0.12))
            .axis_style(INK.mix(0.6))
            .label_style(font(14, INK))
            .axis_desc_style(font(15, INK))
            .x_desc(format!("z, {}{}", if self.unit == "m" { "in " } else { "" }, self.unit))
            .y_desc(self.y_name(chart))
            .draw()?;
        for (c, colour) in CHANNELS.into_iter().enumerate() {
            let held_beyond = match chart {
                Chart::Backscatter => far,
                _ => self.water.attenuation[c].held_beyond().min(far),
            };
            let points = |from: f32, to: f32| {
                (0..=STEPS)
                    .map(move |step| from + (to - from) * f32::from(step) / f32::from(STEPS))
                    .map(|z| (z, curve(z)[c]))
            };
            axes.draw_series(LineSeries::new(points(0.0, held_beyond), colour.stroke_width(2)))?;
            axes.draw_series(LineSeries::new(points(held_beyond, far), colour.mix(0.4).stroke_width(1)))?;
            let dashed = places().filter_map(|z| Some((z, counted(z)?[c])));
            axes.draw_series(DashedLineSeries::new(dashed, DASH.0, DASH.1, colour.stroke_width(1)))?;
            let seen =
                dots.iter().filter_map(|(z, of)| Some((*z, of[c]?))).filter(|&(_, value)| value <= top);
            axes.draw_series(seen.map(|place| Circle::new(place, 3, colour.mix(0.75).filled())))?;
        }
        panel.foot(match chart {
            Chart::Backscatter if self.depth_factors.is_some() => {
                "dots: the darkest pixels; dashed: B∞ (1 − F) of objects in `physical`"
            }
            Chart::Backscatter => "dots: the darkest pixels; black ones lie on the curve",
            Chart::Attenuation => "dots: −ln E / z of each depth; pale: β_D held constant",
            Chart::Illumination => "dots: mean direct signal U − B of each depth, scaled",
        })
    }

    fn curve(&self, chart: Chart, z: f32) -> [f32; 3] {
        match chart {
            Chart::Backscatter => self.water.backscatter(z),
            Chart::Attenuation => self.water.attenuation.map(|curve| curve.coefficient(z)),
            Chart::Illumination => self.water.illumination(z),
        }
    }

    /// Backscatter by the table: B∞ (1 − F).
    fn counted(&self, factors: &DepthFactors, z: f32) -> [f32; 3] {
        let (veil, factors) = (self.water.veiling_light.rgb(), factors.at(z));
        std::array::from_fn(|c| veil[c] * (1.0 - factors[c]))
    }

    fn y_name(&self, chart: Chart) -> String {
        match chart {
            Chart::Backscatter => "B, encoded value".into(),
            Chart::Attenuation if self.unit == "m" => "β_D, per m".into(),
            Chart::Attenuation => "β_D, per unit of z".into(),
            Chart::Illumination => "E, share of the light".into(),
        }
    }
}

/// What was measured at one depth, per channel.
fn sample(chart: Chart, bin: &DepthBin) -> [Option<f32>; 3] {
    match chart {
        Chart::Backscatter => bin.dark.map(Some),
        Chart::Attenuation => bin.illumination.map(|left| left.map(|left| -left.ln() / bin.z)),
        Chart::Illumination => bin.illumination,
    }
}
