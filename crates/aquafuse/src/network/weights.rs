//! The weights: one file of whole numbers of 8 bits, with a scale for each channel.

use super::convolution::Convolution;
use super::layers::Norm;

/// The file that `cargo lab train-network` writes.
const FILE: &[u8] = include_bytes!("weights.bin");
/// What it begins with.
const MARK: &[u8] = b"aquafuse network 1\n";

/// Channels from level to level, each with half the sides of the one before; groups of a normalisation; channels of the result.
const WIDTHS: [usize; 4] = [16, 32, 48, 56];
const GROUPS: usize = 4;
pub(super) const OUTPUTS: usize = 3;
/// Red, green and blue of four pixels.
pub(super) const INPUTS: usize = 12;

/// A convolution, its normalisation, and nothing below 0.
#[derive(Clone, Debug)]
pub(super) struct Layer {
    pub(super) convolution: Convolution,
    pub(super) norm: Norm,
}

/// All that was learned.
#[derive(Clone, Debug)]
pub(super) struct Weights {
    pub(super) stem: Layer,
    pub(super) down: Vec<[Layer; 2]>,
    pub(super) narrow: Vec<Convolution>,
    pub(super) up: Vec<Layer>,
    pub(super) head: Convolution,
    pub(super) bias: [f32; OUTPUTS],
}

impl Weights {
    /// Those of the file, which is part of this crate.
    pub(super) fn new() -> Self {
        let mut file = File(FILE.strip_prefix(MARK).expect("the weights begin with their mark"));
        let [a, b, c, d] = WIDTHS;
        let weights = Self {
            stem: file.layer(INPUTS, a),
            down: [(a, b), (b, c), (c, d)]
                .map(|(from, to)| [file.layer(from, to), file.layer(to, to)])
                .into(),
            narrow: [(d, c), (c, b), (b, a)].map(|(from, to)| file.convolution(from, to, 1)).into(),
            up: [c, b, a].map(|width| file.layer(width, width)).into(),
            head: file.convolution(a, OUTPUTS, 1),
            bias: file.floats(OUTPUTS).try_into().expect("as many as were asked for"),
        };
        assert!(file.0.is_empty(), "the weights end where the network does");
        weights
    }
}

/// What is left of the file.
struct File(&'static [u8]);

impl File {
    fn take(&mut self, count: usize) -> &'static [u8] {
        let (taken, rest) = self.0.split_at(count);
        self.0 = rest;
        taken
    }

    fn floats(&mut self, count: usize) -> Vec<f32> {
        let bytes = self.take(4 * count).as_chunks::<4>().0;
        bytes.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect()
    }

    /// A scale for each channel of the result, then its weights in steps of that.
    fn convolution(&mut self, from: usize, to: usize, side: usize) -> Convolution {
        let scales = self.floats(to);
        let steps: Vec<i8> = self.take(to * from * side * side).iter().map(|step| *step as i8).collect();
        Convolution::new(from, to, side, &scales, &steps)
    }

    fn layer(&mut self, from: usize, to: usize) -> Layer {
        let convolution = self.convolution(from, to, 3);
        let norm = Norm { groups: GROUPS, scale: self.floats(to), shift: self.floats(to) };
        Layer { convolution, norm }
    }
}
