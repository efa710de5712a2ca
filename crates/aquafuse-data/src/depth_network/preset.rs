//! What a network takes and gives, by the names and shapes of its inputs and outputs.

use rten::{DataType, Dimension, Model, NodeId, ValueType};

use super::{NetworkKind, NetworkOptions, SIDES};

/// What is wrong with a network, and what to do.
pub(super) type Unfit = (String, String);

/// How the colours of an image become numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Colours {
    /// From 0 to 1, less the mean of ImageNet, by its deviation.
    ImageNet,
    /// From 0 to 1.
    Unit,
    /// From 0 to 255.
    Bytes,
}

/// A network's input and output.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Preset {
    pub(super) input: NodeId,
    pub(super) output: NodeId,
    pub(super) output_name: String,
    pub(super) kind: NetworkKind,
    pub(super) colours: Colours,
    /// Columns and rows that it takes, if it takes no others.
    pub(super) fixed: [Option<usize>; 2],
}

/// The names of outputs that are depth, best first.
const DEPTHS: [&str; 7] =
    ["metric_depth", "predicted_depth", "depth", "inverse_depth", "disparity", "disp", "inverse"];
const EXPORT: &str =
    "Export the network again with one image as input: 1 x 3 x height x width, RGB, 32-bit floats";

impl Preset {
    pub(super) fn of(model: &Model, options: &NetworkOptions) -> Result<Self, Unfit> {
        let (input, fixed) = input(model)?;
        let names: Vec<String> = model.output_ids().iter().map(|id| name(model, *id)).collect();
        let described = || format!("its outputs are {}", quoted(&names));
        let known =
            DEPTHS.iter().find_map(|depth| Some((*depth, names.iter().position(|name| name == depth)?)));
        let (found, place) = match (known, names.as_slice()) {
            (Some((depth, place)), _) => (Some(depth), place),
            (None, [_]) => (None, 0),
            (None, _) => {
                let remedy = format!(
                    "Export it with one output, or call the one that is depth {}",
                    quoted(&DEPTHS[..3])
                );
                return Err((described(), remedy));
            }
        };
        let beside = |part: &str| names.iter().any(|name| name.contains(part));
        let several = names.len() > 1;
        let (kind, colours) = match found {
            Some("disparity" | "disp" | "inverse_depth" | "inverse") => {
                (Some(NetworkKind::Inverse), Colours::ImageNet)
            }
            Some("metric_depth") => (Some(NetworkKind::Metric), Colours::ImageNet),
            Some("predicted_depth") if beside("normal") => (Some(NetworkKind::Relative), Colours::Bytes),
            Some(_)
                if several
                    && (beside("points") || beside("mask") || beside("normal") || beside("confidence")) =>
            {
                (Some(NetworkKind::Relative), Colours::Unit)
            }
            Some(_) if !several && ["image", "pixel_values"].contains(&name(model, input).as_str()) => {
                (Some(NetworkKind::Inverse), Colours::ImageNet)
            }
            _ => (None, Colours::ImageNet),
        };
        let Some(kind) = options.kind.or(kind) else {
            let cause = format!(
                "its input is `{}`, {}, which says nothing of its numbers",
                name(model, input),
                described()
            );
            let remedy = "Say what they are with --depth-model-kind inverse (larger is nearer), metric (metres) or relative \
                          (larger is farther)";
            return Err((cause, remedy.into()));
        };
        let output_name = names.get(place).cloned().unwrap_or_default();
        let output = *model.output_ids().get(place).expect("there is a name for each output");
        Ok(Self { input, output, output_name, kind, colours, fixed })
    }

    /// Columns and rows of the input for an image of this size.
    pub(super) fn size(&self, (width, height): (usize, usize), side: u32) -> (usize, usize) {
        let aspect = (width as f64 / height as f64).sqrt();
        let of =
            |fixed: Option<usize>, side: f64| fixed.unwrap_or_else(|| PATCH.saturating_mul(in_patches(side)));
        let [columns, rows] = self.fixed;
        (of(columns, f64::from(side) * aspect), of(rows, f64::from(side) / aspect))
    }
}

/// Sides of the patches of vision transformers; others take multiples of it too, or have a fixed size.
const PATCH: usize = 14;

#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to a small range")]
fn in_patches(side: f64) -> usize {
    (side / PATCH as f64).round().clamp(1.0, 1024.0) as usize
}

fn name(model: &Model, id: NodeId) -> String {
    model.node_info(id).and_then(|info| info.name().map(str::to_owned)).unwrap_or_default()
}

fn quoted(names: &[impl AsRef<str>]) -> String {
    names.iter().map(|name| format!("`{}`", name.as_ref())).collect::<Vec<_>>().join(", ")
}

/// The input, and the columns and rows that it must have.
fn input(model: &Model) -> Result<(NodeId, [Option<usize>; 2]), Unfit> {
    let unfit = |cause: String| (cause, EXPORT.to_owned());
    let &[input] = model.input_ids() else {
        let names: Vec<String> = model.input_ids().iter().map(|id| name(model, *id)).collect();
        return Err(unfit(format!("it has {} inputs ({})", names.len(), quoted(&names))));
    };
    let info = model.node_info(input);
    if let Some(kind) = info
        .as_ref()
        .and_then(rten::NodeInfo::dtype)
        .filter(|kind| *kind != ValueType::Tensor(DataType::Float))
    {
        return Err(unfit(format!("its input takes {kind:?} instead of 32-bit floats")));
    }
    let Some(shape) = info.and_then(|info| info.shape()) else { return Ok((input, [None; 2])) };
    let shown = || shape.iter().map(shown).collect::<Vec<_>>().join(" x ");
    let [count, channels, rows, columns] = shape.as_slice() else {
        return Err(unfit(format!("its input is {}", shown())));
    };
    let may_be = |side: &Dimension, wanted: usize| !matches!(side, Dimension::Fixed(side) if *side != wanted);
    if !may_be(count, 1) || !may_be(channels, 3) {
        return Err(unfit(format!("its input is {}", shown())));
    }
    let fixed = [columns, rows].map(|side| match side {
        Dimension::Fixed(side) => Some(*side),
        Dimension::Symbolic(_) => None,
    });
    let is_side = |side: usize| u32::try_from(side).is_ok_and(|side| SIDES.contains(&side));
    if fixed.iter().flatten().any(|side| !is_side(*side)) {
        return Err(unfit(format!(
            "its input is {}, but sides must be from {} to {}",
            shown(),
            SIDES.start(),
            SIDES.end()
        )));
    }
    Ok((input, fixed))
}

fn shown(side: &Dimension) -> String {
    match side {
        Dimension::Fixed(side) => side.to_string(),
        Dimension::Symbolic(name) => name.clone(),
    }
}
