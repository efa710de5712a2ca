//! Whether every message of a file of ONNX lies whole within the one that holds it.
//!
//! The reader believes the length that a message says: where it is beyond the end, it asks for as much memory, or reads on for
//! ever; and so it does at a number of more than ten bytes in a list. So each message that it reads is walked through before.

use super::contents::{Value, each, is_list, refused};
use super::preset::Unfit;

/// Messages within messages: a type of a value in a graph in an attribute takes eight.
const DEEPEST: usize = 64;

/// The kinds of messages that the reader reads.
#[derive(Clone, Copy)]
enum Message {
    Model,
    Graph,
    Node,
    Attribute,
    Tensor,
    Value,
    Type,
    TensorType,
    SequenceType,
    Shape,
    Side,
    Entry,
}

impl Message {
    /// What a field of it holds, if that is a message.
    fn within(self, field: u64) -> Option<Self> {
        Some(match (self, field) {
            (Self::Model, 7) | (Self::Attribute, 6) => Self::Graph,
            (Self::Model, 14) | (Self::Tensor, 13) => Self::Entry,
            (Self::Graph, 1) => Self::Node,
            (Self::Graph, 5) | (Self::Attribute, 5) => Self::Tensor,
            (Self::Graph, 11..=13) => Self::Value,
            (Self::Node, 5) => Self::Attribute,
            (Self::Value, 2) | (Self::SequenceType, 1) => Self::Type,
            (Self::Type, 1) => Self::TensorType,
            (Self::Type, 4) => Self::SequenceType,
            (Self::TensorType, 2) => Self::Shape,
            (Self::Shape, 1) => Self::Side,
            _ => return None,
        })
    }

    /// Whether a field of it is a list of whole numbers, if it holds bytes.
    fn has_list(self, field: u64) -> bool {
        matches!((self, field), (Self::Tensor, 5 | 7))
    }

    fn check(self, message: &[u8], depth: usize) -> Result<(), Unfit> {
        if depth > DEEPEST {
            return Err(refused(&format!("its messages lie in one another more than {DEEPEST} deep")));
        }
        each(message, &mut |field, value| match (self.within(field), value) {
            (Some(inner), Value::Bytes(bytes)) => inner.check(bytes, depth.saturating_add(1)),
            (Some(_), _) => Err(refused("it has a number where a message belongs")),
            (None, Value::Bytes(list)) if self.has_list(field) && !is_list(list) => {
                Err(refused("a list of numbers in it is damaged"))
            }
            (None, _) => Ok(()),
        })
    }
}

/// Refuses a file one of whose messages is cut short or too deep within others.
pub(super) fn check(file: &[u8]) -> Result<(), Unfit> {
    Message::Model.check(file, 0)
}

#[cfg(test)]
mod tests {
    use super::check;

    /// A message of these bytes in a field of another.
    fn field(number: u8, bytes: &[u8]) -> Vec<u8> {
        // A length of two groups of seven bits.
        let length = [bytes.len() as u8 | 128, (bytes.len() >> 7) as u8];
        [&[number << 3 | 2], &length[..], bytes].concat()
    }

    #[test]
    fn a_message_that_says_more_than_there_is_is_refused_wherever_it_lies() {
        // A text of 100 bytes, of which one is there.
        let beyond = [10, 100, b'a'];
        // As deep as the size of an input's side, and what describes the model.
        let paths: [&[u8]; 5] =
            [&[7, 11, 2, 1, 2, 1], &[7, 12], &[7, 1, 5, 6, 13], &[14], &[7, 11, 2, 4, 1, 1]];
        for path in paths {
            let wrapped =
                |inner: &[u8]| path.iter().rev().fold(inner.to_vec(), |inner, at| field(*at, &inner));
            assert!(check(&wrapped(&[10, 1, b'a'])).is_ok(), "{path:?}");
            let (cause, _) = check(&wrapped(&beyond)).unwrap_err();
            assert!(cause.contains("cut short"), "{path:?}: {cause}");
        }
    }

    #[test]
    fn a_number_that_never_ends_is_refused_in_every_list_that_is_read() {
        // The reader reads on for ever at ten bytes that each say that another follows.
        for list in [5, 7] {
            let model = |numbers: &[u8]| check(&field(7, &field(5, &field(list, numbers))));
            assert!(model(&[1, 0x80, 1, 2]).is_ok());
            let (cause, _) = model(&[&[1][..], &[0xff; 12]].concat()).unwrap_err();
            assert!(cause.contains("damaged"), "{cause}");
        }
    }

    #[test]
    fn sequences_of_sequences_have_an_end() {
        let nested = |times: usize| {
            let kind = (0..times).fold(Vec::new(), |inner, _| field(4, &field(1, &inner)));
            check(&field(7, &field(11, &field(2, &kind))))
        };
        assert!(nested(30).is_ok());
        assert!(nested(31).unwrap_err().0.contains("64 deep"));
    }
}
