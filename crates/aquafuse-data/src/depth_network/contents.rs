//! What a file of ONNX holds, looked through before its reader takes memory for it.
//!
//! The reader trusts what a file says about itself. A network of depth needs no loops, few operators, and constants that are in the
//! file; anything else is refused here, by name.

use std::collections::HashMap;

use super::messages;
use super::preset::Unfit;

/// Operators of the largest networks of depth, ten times over.
const MOST_OPERATORS: usize = 50_000;
/// Graphs within graphs.
const DEEPEST: usize = 8;
/// Numbers that one operator may make out of constants that say how many.
const MOST_NUMBERS: u64 = 1 << 28;
/// Operators whose time nothing bounds.
const UNBOUNDED: [&str; 2] = ["Loop", "Scan"];
/// Operators that make a tensor as large as one of their inputs says, and which of them.
const SIZED: [(&str, usize); 4] = [("ConstantOfShape", 0), ("Expand", 1), ("Tile", 1), ("Resize", 3)];
const FOREIGN: &str =
    "Give a network of depth in the format ONNX, whole and with its weights in the same file";

/// Refuses a file that is cut short, that keeps its weights elsewhere, or whose work nothing bounds.
pub(super) fn check(file: &[u8]) -> Result<(), Unfit> {
    let mut operators = 0;
    let mut found = false;
    each(file, &mut |number, value| match (number, value) {
        (GRAPH, Value::Bytes(graph)) => {
            found = true;
            check_graph(graph, 0, &mut operators)
        }
        _ => Ok(()),
    })?;
    if found { messages::check(file) } else { Err(refused("it holds no graph of operators")) }
}

/// Fields of a model, a graph, an operator, an attribute and a tensor.
const GRAPH: u64 = 7;
const NODE: u64 = 1;
const INITIALIZER: u64 = 5;
const INPUT: u64 = 1;
const OUTPUT: u64 = 2;
const OPERATOR: u64 = 4;
const ATTRIBUTE: u64 = 5;
const TENSOR_OF: u64 = 5;
const GRAPH_OF: u64 = 6;
const DIMENSIONS: u64 = 1;
const TYPE: u64 = 2;
const WHOLE_NUMBERS: u64 = 7;
const NAME: u64 = 8;
const RAW: u64 = 9;
const EXTERNAL: u64 = 13;
/// The type of 64-bit whole numbers, of which shapes consist.
const INT64: u64 = 7;

/// What an operator is and takes.
#[derive(Default)]
struct Operator<'a> {
    name: &'a [u8],
    inputs: Vec<&'a [u8]>,
    outputs: Vec<&'a [u8]>,
}

fn check_graph(graph: &[u8], depth: usize, operators: &mut usize) -> Result<(), Unfit> {
    if depth > DEEPEST {
        return Err(refused(&format!("its graphs lie in one another more than {DEEPEST} deep")));
    }
    // Constants of whole numbers, by name: how many numbers a tensor of that shape has.
    let mut sizes: HashMap<&[u8], u64> = HashMap::new();
    let mut sized: Vec<Operator<'_>> = Vec::new();
    each(graph, &mut |number, value| {
        match (number, value) {
            (NODE, Value::Bytes(node)) => {
                *operators = operators.saturating_add(1);
                if *operators > MOST_OPERATORS {
                    return Err(refused(&format!("it has more than {MOST_OPERATORS} operators")));
                }
                let (operator, constant) = operator_of(node, depth, operators)?;
                if let (Some(size), Some(name)) = (constant, operator.outputs.first()) {
                    sizes.insert(name, size);
                }
                let is = |name: &str| operator.name == name.as_bytes();
                if let Some(name) = UNBOUNDED.iter().find(|name| is(name)) {
                    return Err(refused(&format!("it has the operator {name}, which may never end")));
                }
                if SIZED.iter().any(|(name, _)| is(name)) {
                    sized.push(operator);
                }
            }
            (INITIALIZER, Value::Bytes(tensor)) => {
                let (name, size) = check_tensor(tensor)?;
                sizes.extend(size.map(|size| (name, size)));
            }
            _ => {}
        }
        Ok(())
    })?;
    for operator in sized {
        let place = SIZED.iter().find(|(name, _)| operator.name == name.as_bytes());
        let input = place.and_then(|(name, place)| Some((*name, *operator.inputs.get(*place)?)));
        if let Some((name, size)) = input.and_then(|(name, input)| Some((name, *sizes.get(input)?)))
            && size > MOST_NUMBERS
        {
            return Err(refused(&format!("its operator {name} makes {size} numbers at once")));
        }
    }
    Ok(())
}

/// An operator, and the size of the tensor whose shape it holds, if it is a constant of whole numbers.
fn operator_of<'a>(
    node: &'a [u8],
    depth: usize,
    operators: &mut usize,
) -> Result<(Operator<'a>, Option<u64>), Unfit> {
    let mut operator = Operator::default();
    let mut constant = None;
    each(node, &mut |number, value| {
        match (number, value) {
            (INPUT, Value::Bytes(name)) => operator.inputs.push(name),
            (OUTPUT, Value::Bytes(name)) => operator.outputs.push(name),
            (OPERATOR, Value::Bytes(name)) => operator.name = name,
            (ATTRIBUTE, Value::Bytes(attribute)) => each(attribute, &mut |number, value| {
                match (number, value) {
                    (TENSOR_OF, Value::Bytes(tensor)) => constant = check_tensor(tensor)?.1,
                    (GRAPH_OF, Value::Bytes(graph)) => {
                        check_graph(graph, depth.saturating_add(1), operators)?;
                    }
                    _ => {}
                }
                Ok(())
            })?,
            _ => {}
        }
        Ok(())
    })?;
    Ok((operator, constant))
}

/// The name of a constant, and how many numbers a tensor has whose shape it is.
fn check_tensor(tensor: &[u8]) -> Result<(&[u8], Option<u64>), Unfit> {
    let (mut name, mut kind, mut count, mut raw) = (&b""[..], 0, 1_u64, None);
    let mut sides = Vec::new();
    each(tensor, &mut |number, value| {
        match (number, value) {
            (DIMENSIONS, Value::Number(side)) => count = count.saturating_mul(side),
            (DIMENSIONS, Value::Bytes(sides)) => {
                let mut packed = Bytes(sides);
                while let Some(side) = packed.varint() {
                    count = count.saturating_mul(side);
                }
            }
            (TYPE, Value::Number(number)) => kind = number,
            (NAME, Value::Bytes(bytes)) => name = bytes,
            (RAW, Value::Bytes(bytes)) => raw = Some(bytes),
            (WHOLE_NUMBERS, Value::Number(side)) => sides.push(side),
            (WHOLE_NUMBERS, Value::Bytes(bytes)) => {
                let mut packed = Bytes(bytes);
                sides.extend(std::iter::from_fn(|| packed.varint()));
            }
            (EXTERNAL, _) => return Err(refused("its weights are in another file")),
            _ => {}
        }
        Ok(())
    })?;
    if let Some(raw) = raw {
        // A value has a byte at least, or half a byte in the narrowest types.
        if count > (raw.len() as u64).saturating_mul(2) {
            let name = String::from_utf8_lossy(name);
            return Err(refused(&format!("its constant `{name}` has {count} values in {} bytes", raw.len())));
        }
        sides = raw.as_chunks::<8>().0.iter().map(|side| u64::from_le_bytes(*side)).collect();
    }
    // Sides of 0 or below mean others; so do the largest ones, which ask for all there is.
    let is_side = |side: &u64| (1..1 << 40).contains(side);
    let size = sides.iter().copied().filter(is_side).fold(1, u64::saturating_mul);
    Ok((name, (kind == INT64 && !sides.is_empty()).then_some(size)))
}

pub(super) fn refused(cause: &str) -> Unfit {
    (cause.to_owned(), FOREIGN.to_owned())
}

/// What a field holds.
#[derive(Clone, Copy)]
pub(super) enum Value<'a> {
    Number(u64),
    Bytes(&'a [u8]),
    Other,
}

/// Calls `visit` with each field of a message of protocol buffers.
pub(super) fn each<'a>(
    message: &'a [u8],
    visit: &mut dyn FnMut(u64, Value<'a>) -> Result<(), Unfit>,
) -> Result<(), Unfit> {
    let mut rest = Bytes(message);
    while !rest.0.is_empty() {
        let Some((number, value)) = rest.field() else {
            return Err(refused("it is cut short, or no file of ONNX"));
        };
        visit(number, value)?;
    }
    Ok(())
}

/// Whether bytes are whole numbers one after another, and nothing else.
pub(super) fn is_list(list: &[u8]) -> bool {
    let mut rest = Bytes(list);
    while !rest.0.is_empty() {
        if rest.varint().is_none() {
            return false;
        }
    }
    true
}

struct Bytes<'a>(&'a [u8]);

impl<'a> Bytes<'a> {
    fn varint(&mut self) -> Option<u64> {
        let mut value = 0_u64;
        for place in 0..10 {
            let (byte, rest) = self.0.split_first()?;
            self.0 = rest;
            value |= u64::from(*byte & 127).checked_shl(7_u32.saturating_mul(place))?;
            if *byte < 128 {
                return Some(value);
            }
        }
        None
    }

    fn take(&mut self, length: u64) -> Option<&'a [u8]> {
        let (taken, rest) = self.0.split_at_checked(usize::try_from(length).ok()?)?;
        self.0 = rest;
        Some(taken)
    }

    fn field(&mut self) -> Option<(u64, Value<'a>)> {
        let tag = self.varint()?;
        let value = match tag & 7 {
            0 => Value::Number(self.varint()?),
            1 => self.take(8).map(|_| Value::Other)?,
            2 => {
                let length = self.varint()?;
                Value::Bytes(self.take(length)?)
            }
            5 => self.take(4).map(|_| Value::Other)?,
            _ => return None,
        };
        Some((tag >> 3, value))
    }
}
