//! LPIPS by a network that the test makes itself: one layer, small enough to be computed by hand.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up its case should fail loudly")]

mod protobuf;

use aquafuse::image::Image;
use aquafuse_data::evaluate::Lpips;
use protobuf::{field, number};

/// Features of the one layer.
const FEATURES: usize = 4;

fn node(operator: &str, inputs: &[&str], output: &str, attributes: &[Vec<u8>]) -> Vec<u8> {
    let inputs = inputs.iter().map(|name| field(1, name.as_bytes()));
    // Operators and what they give may not share a name.
    let name = format!("make {output}");
    let named = [field(2, output.as_bytes()), field(3, name.as_bytes()), field(4, operator.as_bytes())];
    let attributes = attributes.iter().map(|attribute| field(5, attribute));
    field(1, &inputs.chain(named).chain(attributes).collect::<Vec<_>>().concat())
}

/// An attribute of whole numbers (type 7), or of one (type 2).
fn whole_numbers(name: &str, values: &[u64]) -> Vec<u8> {
    let values = values.iter().flat_map(|value| number(8, *value)).collect();
    [field(1, name.as_bytes()), values, number(20, 7)].concat()
}

fn whole_number(name: &str, value: u64) -> Vec<u8> {
    [field(1, name.as_bytes()), number(3, value), number(20, 2)].concat()
}

/// Weights: floats, or the axes that an operator sums over.
fn floats(name: &str, shape: &[u64], values: &[f32]) -> Vec<u8> {
    let shape = shape.iter().flat_map(|side| number(1, *side)).collect();
    let raw: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
    field(5, &[shape, number(2, 1), field(8, name.as_bytes()), field(9, &raw)].concat())
}

fn axes(name: &str, values: &[i64]) -> Vec<u8> {
    let raw: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
    let shape = number(1, values.len() as u64);
    field(5, &[shape, number(2, 7), field(8, name.as_bytes()), field(9, &raw)].concat())
}

fn image_value(field_number: u8, name: &str) -> Vec<u8> {
    let free = |name: &str| field(1, &field(2, name.as_bytes()));
    let fixed = |side: u64| field(1, &number(1, side));
    let shape = [fixed(1), fixed(3), free("height"), free("width")].concat();
    let tensor = field(1, &[number(1, 1), field(2, &shape)].concat());
    field(field_number, &[field(1, name.as_bytes()), field(2, &tensor)].concat())
}

/// Weights of the 3 x 3 convolution and of the features.
fn weights() -> (Vec<f32>, Vec<f32>) {
    let kernel = (0..FEATURES * 27).map(|i| ((i * 37 + 11) % 23) as f32 / 23.0 - 0.5).collect();
    (kernel, vec![0.5, 0.25, 1.0, 0.125])
}

/// LPIPS with one layer: features, scaled to length 1 at each place; their squared differences, weighed and averaged.
fn network() -> Vec<u8> {
    let (kernel, weighed) = weights();
    // A convolution at every pixel, all of it said, as exporters do.
    let dense = |pad: u64| {
        let sides = ["strides", "dilations"].map(|name| whole_numbers(name, &[1, 1]));
        [sides.to_vec(), vec![whole_numbers("pads", &[pad; 4])]].concat()
    };
    let mut graph = Vec::new();
    for side in ["a", "b"] {
        let named = |of: &str| format!("{side}_{of}");
        graph.push(node("Conv", &[side, "kernel"], &named("conv"), &dense(1)));
        graph.push(node("Relu", &[&named("conv")], &named("features"), &[]));
        graph.push(node("Mul", &[&named("features"), &named("features")], &named("squares"), &[]));
        let keep = || whole_number("keepdims", 1);
        graph.push(node("ReduceSum", &[&named("squares"), "channel"], &named("sum"), &[keep()]));
        graph.push(node("Sqrt", &[&named("sum")], &named("length"), &[]));
        graph.push(node("Add", &[&named("length"), "little"], &named("divisor"), &[]));
        graph.push(node("Div", &[&named("features"), &named("divisor")], &named("unit"), &[]));
    }
    graph.push(node("Sub", &["a_unit", "b_unit"], "difference", &[]));
    graph.push(node("Mul", &["difference", "difference"], "squared", &[]));
    graph.push(node("Conv", &["squared", "weighed"], "map", &dense(0)));
    let over = [whole_numbers("axes", &[2, 3]), whole_number("keepdims", 1)];
    graph.push(node("ReduceMean", &["map"], "distance", &over));
    graph.push(field(2, b"lpips"));
    graph.push(floats("kernel", &[FEATURES as u64, 3, 3, 3], &kernel));
    graph.push(floats("weighed", &[1, FEATURES as u64, 1, 1], &weighed));
    graph.push(floats("little", &[1], &[1e-10]));
    graph.push(axes("channel", &[1]));
    graph.push(image_value(11, "a"));
    graph.push(image_value(11, "b"));
    graph.push(field(12, &field(1, b"distance")));
    let version = field(8, &number(2, 17));
    [number(1, 8), field(7, &graph.concat()), version].concat()
}

/// The same by hand.
fn expected(a: &Image<u8>, b: &Image<u8>) -> f64 {
    let (kernel, weighed) = weights();
    let (width, height) = a.size();
    let features = |image: &Image<u8>, x: usize, y: usize| -> Vec<f64> {
        let mut found = [0.0; FEATURES];
        for (f, sum) in found.iter_mut().enumerate() {
            for (c, (dy, dx)) in (0..3).flat_map(|c| (0..9).map(move |k| (c, (k / 3, k % 3)))) {
                let (px, py) = ((x + dx).wrapping_sub(1), (y + dy).wrapping_sub(1));
                if px < width && py < height {
                    let value = f64::from(image.pixels()[py * width + px][c]) / 127.5 - 1.0;
                    *sum += value * f64::from(kernel[((f * 3 + c) * 3 + dy) * 3 + dx]);
                }
            }
            *sum = sum.max(0.0);
        }
        let length = found.iter().map(|value| value * value).sum::<f64>().sqrt() + 1e-10;
        found.iter().map(|value| value / length).collect()
    };
    let at = |x: usize, y: usize| -> f64 {
        let (a, b) = (features(a, x, y), features(b, x, y));
        (0..FEATURES).map(|f| f64::from(weighed[f]) * (a[f] - b[f]).powi(2)).sum()
    };
    let sum: f64 = (0..height).flat_map(|y| (0..width).map(move |x| at(x, y))).sum();
    sum / (width * height) as f64
}

fn image_file(width: usize, height: usize, step: usize) -> Image<u8> {
    let bytes = (0..3 * width * height).map(|i| (i * step % 251) as u8).collect();
    Image::from_raw(width, height, bytes).unwrap()
}

fn read(bytes: &[u8]) -> Result<Lpips, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("network.onnx");
    std::fs::write(&path, bytes).unwrap();
    Lpips::read(&path).map_err(|error| error.to_string())
}

#[test]
fn the_distance_is_that_of_the_publications_formula() {
    let lpips = read(&network()).unwrap();
    // Any size; not square, so that rows and columns cannot be taken for each other.
    for (width, height) in [(17, 9), (24, 31)] {
        let (a, b) = (image_file(width, height, 37), image_file(width, height, 101));
        let (found, expected) = (lpips.distance(&a, &b).unwrap(), expected(&a, &b));
        assert!(expected > 0.01 && (found - expected).abs() < 1e-5 * expected, "{found} for {expected}");
        assert_eq!(lpips.distance(&a, &a).unwrap(), 0.0);
        assert_eq!(lpips.distance(&b, &a).unwrap(), found);
    }
}

#[test]
fn what_is_no_network_is_refused_by_cause() {
    let whole = network();
    for bytes in [&b"no network"[..], &whole[..whole.len() / 2], &[0x0a, 0xff, 0xff, 0xff, 0xff, 0x7f]] {
        let refused = read(bytes).unwrap_err();
        assert!(refused.contains("network.onnx") && refused.contains("export.py"), "{refused}");
    }
}

/// The generator of PyTorch: `torch.manual_seed(seed)`, then `torch.rand`.
struct Twister {
    state: [u32; 624],
    next: usize,
}

impl Twister {
    fn new(seed: u32) -> Self {
        let mut state = [seed; 624];
        for i in 1..624 {
            let before = state[i - 1] ^ (state[i - 1] >> 30);
            state[i] = before.wrapping_mul(1_812_433_253).wrapping_add(i as u32);
        }
        Self { state, next: 624 }
    }

    fn number(&mut self) -> u32 {
        if self.next == 624 {
            for i in 0..624 {
                let both = (self.state[i] & 1 << 31) | (self.state[(i + 1) % 624] & ((1 << 31) - 1));
                let odd = if both & 1 == 1 { 0x9908_b0df } else { 0 };
                self.state[i] = self.state[(i + 397) % 624] ^ (both >> 1) ^ odd;
            }
            self.next = 0;
        }
        let mut number = self.state[self.next];
        self.next += 1;
        number ^= number >> 11;
        number ^= (number << 7) & 0x9d2c_5680;
        number ^= (number << 15) & 0xefc6_0000;
        number ^ (number >> 18)
    }

    /// The next images of a batch: plane after plane, from 0 to 1.
    fn image_files(&mut self, count: usize, side: usize) -> Vec<Image<u8>> {
        let mut one = || {
            let mut bytes = vec![0; 3 * side * side];
            for channel in 0..3 {
                for place in 0..side * side {
                    let value = (self.number() & ((1 << 24) - 1)) as f32 / (1 << 24) as f32;
                    bytes[3 * place + channel] = (255.0 * value).round() as u8;
                }
            }
            Image::from_raw(side, side, bytes).unwrap()
        };
        (0..count).map(|_| one()).collect()
    }
}

#[test]
fn the_generator_is_the_one_that_everybody_has() {
    // Of MT19937 seeded with 5489, the ten thousandth number (C++ standard, [rand.predef]).
    let mut twister = Twister::new(5489);
    let last = (0..10_000).map(|_| twister.number()).last();
    assert_eq!(last, Some(4_123_659_995));
}

#[test]
fn with_weights_that_were_published_the_distance_is_the_one_that_was_published() {
    let Some(path) = std::env::var_os("AQUAFUSE_LPIPS_WEIGHTS") else {
        println!("skipped: AQUAFUSE_LPIPS_WEIGHTS names no network of SqueezeNet written by lpips/export.py");
        return;
    };
    let lpips = Lpips::read(path.as_ref()).unwrap();
    // TorchMetrics' documentation of LearnedPerceptualImagePatchSimilarity: seed 42, ten images of 100 x 100 and ten
    // more, net_type='squeeze'. Ours are rounded to bytes.
    let mut twister = Twister::new(42);
    let (these, those) = (twister.image_files(10, 100), twister.image_files(10, 100));
    let distances = these.iter().zip(&those).map(|(a, b)| lpips.distance(a, b).unwrap());
    let mean = distances.sum::<f64>() / 10.0;
    assert!((mean - 0.1024).abs() < 5e-4, "{mean}");
}
