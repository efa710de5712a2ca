//! Thrift's compact protocol, as far as it takes to pass over what is not needed: fields with their kind and number, and
//! values of every kind. Within a list each value has at least one byte, so that a length is as good as the bytes that
//! follow it; lists of Booleans, which no header or footer contains, are refused, for the library that reads tables
//! afterwards takes them to have no bytes, and would count through thousands of millions of them.
//! <https://github.com/apache/thrift/blob/master/doc/specs/thrift-compact-protocol.md>

use std::io::{self, ErrorKind, Read};

use super::shapes::Shape;

/// The kind of a struct.
const STRUCT: u8 = 12;

/// The kind of the next field of a struct, whose number goes on from that of the field before; none at its end.
pub(super) fn next_field(from: &mut impl Read, field: &mut i16) -> io::Result<Option<u8>> {
    let byte = byte(from)?;
    if byte & 0xf == 0 {
        return Ok(None);
    }
    let next = match byte >> 4 {
        0 => i16::try_from(unfolded(number(from)?)).ok(),
        further => field.checked_add(i16::from(further)),
    };
    *field = next.ok_or_else(|| odd("a field number that is out of range"))?;
    Ok(Some(byte & 0xf))
}

/// Reads a struct of this shape and drops it; within it there may be `deepest` structs and lists, one in the other.
pub(super) fn pass_over_struct(from: &mut impl Read, shape: Option<Shape>, deepest: u32) -> io::Result<()> {
    let mut field = 0;
    while let Some(kind) = next_field(from, &mut field)? {
        pass_over(from, kind, shape.and_then(|shape| shape.field(field)), deepest)?;
    }
    Ok(())
}

/// Reads a value of this kind and drops it; it must be of the shape, where that is known.
pub(super) fn pass_over(
    from: &mut impl Read,
    kind: u8,
    shape: Option<Shape>,
    deepest: u32,
) -> io::Result<()> {
    if shape.is_some_and(|shape| !shape.is(kind)) {
        return Err(odd("a field of the wrong type"));
    }
    let deeper = || deepest.checked_sub(1).ok_or_else(|| odd("structs nested too deeply"));
    match kind {
        // Of a Boolean the kind is the value.
        1 | 2 => Ok(()),
        3 => byte(from).map(drop),
        4..=6 => number(from).map(drop),
        7 => bytes(from, 8),
        8 => {
            let length = number(from)?;
            bytes(from, length)
        }
        9 | 10 => {
            let head = byte(from)?;
            let length = if head >> 4 == 0xf { number(from)? } else { u64::from(head >> 4) };
            let kind = head & 0xf;
            if matches!(kind, 1 | 2) && length > 0 {
                return Err(odd("a list of Booleans, which no table has"));
            }
            let of = shape.and_then(Shape::of_list);
            (0..length).try_for_each(|_| pass_over(from, kind, of, deeper()?))
        }
        STRUCT => pass_over_struct(from, shape, deeper()?),
        _ => Err(odd("a field of no known kind")),
    }
}

fn byte(from: &mut impl Read) -> io::Result<u8> {
    let mut byte = [0];
    from.read_exact(&mut byte)?;
    Ok(byte[0])
}

fn bytes(from: &mut impl Read, length: u64) -> io::Result<()> {
    let passed = io::copy(&mut from.take(length), &mut io::sink())?;
    if passed < length { Err(ErrorKind::UnexpectedEof.into()) } else { Ok(()) }
}

/// Seven bits a byte, the lowest first.
pub(super) fn number(from: &mut impl Read) -> io::Result<u64> {
    let mut number = 0;
    for shift in (0..64).step_by(7) {
        let byte = byte(from)?;
        number |= u64::from(byte & 0x7f) << shift;
        if byte < 0x80 {
            return Ok(number);
        }
    }
    Err(odd("a number without end"))
}

/// A number with its sign, which is its lowest bit.
pub(super) fn unfolded(number: u64) -> i64 {
    let half = (number >> 1).cast_signed();
    if number & 1 == 0 { half } else { !half }
}

pub(super) fn odd(what: &str) -> io::Error {
    io::Error::new(ErrorKind::InvalidData, what)
}
