//! Small networks as ONNX, written field by field.

#[path = "../protobuf/mod.rs"]
pub(crate) mod protobuf;

use protobuf::{field, number};

/// 32-bit floats and 64-bit whole numbers, as ONNX numbers its types.
pub(crate) const FLOAT: u64 = 1;
pub(crate) const INT64: u64 = 7;
const UINT8: u64 = 2;

/// An operator: its name, inputs, output and whole-number attributes.
pub(crate) type Node<'a> = (&'a str, &'a [&'a str], &'a str, &'a [(&'a str, u64)]);
/// A constant: its name, type, shape and values.
pub(crate) type Constant<'a> = (&'a str, u64, &'a [u64], &'a [f64]);

/// A network of one input.
pub(crate) struct Network<'a> {
    pub(crate) input: (&'a str, &'a [u64]),
    pub(crate) input_type: u64,
    pub(crate) outputs: &'a [&'a str],
    pub(crate) nodes: &'a [Node<'a>],
    pub(crate) constants: &'a [Constant<'a>],
}

impl Network<'_> {
    /// The mean of the channels: 1 x 3 x height x width to 1 x height x width. A side of 0 is any.
    pub(crate) const MEAN: Self = Self {
        input: ("image", &[1, 3, 0, 0]),
        input_type: FLOAT,
        outputs: &["depth"],
        nodes: &[("ReduceMean", &["image", "channels"], "depth", &[("keepdims", 0)])],
        constants: &[("channels", INT64, &[1], &[1.0])],
    };

    /// One whose input holds bytes.
    #[allow(dead_code, reason = "not every test that includes this file has such a network")]
    pub(crate) fn of_bytes() -> Self {
        Self { input_type: UINT8, ..Self::MEAN }
    }

    pub(crate) fn file(&self) -> Vec<u8> {
        let mut graph = Vec::new();
        for (operator, inputs, output, attributes) in self.nodes {
            let inputs = inputs.iter().flat_map(|name| field(1, name.as_bytes()));
            let name = format!("make {output}");
            let named =
                [field(2, output.as_bytes()), field(3, name.as_bytes()), field(4, operator.as_bytes())];
            let attributes = attributes.iter().flat_map(|(name, value)| {
                field(5, &[field(1, name.as_bytes()), number(3, *value), number(20, 2)].concat())
            });
            graph.push(field(1, &inputs.chain(named.concat()).chain(attributes).collect::<Vec<_>>()));
        }
        graph.push(field(2, b"depth"));
        for (name, kind, shape, values) in self.constants {
            let shape = shape.iter().flat_map(|side| number(1, *side)).collect();
            let raw: Vec<u8> = match *kind {
                INT64 => values.iter().flat_map(|value| (*value as i64).to_le_bytes()).collect(),
                _ => values.iter().flat_map(|value| (*value as f32).to_le_bytes()).collect(),
            };
            graph.push(field(
                5,
                &[shape, number(2, *kind), field(8, name.as_bytes()), field(9, &raw)].concat(),
            ));
        }
        let side = |(i, side): (usize, &u64)| match side {
            0 => field(1, &field(2, format!("side {i}").as_bytes())),
            side => field(1, &number(1, *side)),
        };
        let shape: Vec<u8> = self.input.1.iter().enumerate().flat_map(side).collect();
        let tensor = field(1, &[number(1, self.input_type), field(2, &shape)].concat());
        graph.push(field(11, &[field(1, self.input.0.as_bytes()), field(2, &tensor)].concat()));
        graph.extend(self.outputs.iter().map(|name| field(12, &field(1, name.as_bytes()))));
        [number(1, 8), field(7, &graph.concat()), field(8, &number(2, 18))].concat()
    }
}
