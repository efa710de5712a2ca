//! What the fields of a table's footer and of its pages' headers hold, by their numbers.
//!
//! The library goes by a field's number where it knows it, and by the kind that the file gives where it does not. Only if both
//! say the same is what was passed over here what the library reads afterwards.
//! <https://github.com/apache/parquet-format/blob/master/src/main/thrift/parquet.thrift>

use Shape::{Byte, Bytes, Double, Flag, List, Number, Struct};

/// What a value is, and what is in it.
#[derive(Clone, Copy, Debug)]
pub(super) enum Shape {
    Flag,
    Byte,
    /// Of 16, 32 or 64 bits, which are written alike.
    Number,
    Double,
    Bytes,
    List(&'static Self),
    /// Fields by their numbers.
    Struct(&'static [(i16, Self)]),
}

impl Shape {
    /// Whether a value of this kind, as Thrift counts kinds, has this shape from outside.
    pub(super) const fn is(self, kind: u8) -> bool {
        matches!(
            (self, kind),
            (Flag, 1 | 2)
                | (Byte, 3)
                | (Number, 4..=6)
                | (Double, 7)
                | (Bytes, 8)
                | (List(_), 9)
                | (Struct(_), 12)
        )
    }

    /// What a list holds.
    pub(super) const fn of_list(self) -> Option<Self> {
        match self {
            List(of) => Some(*of),
            _ => None,
        }
    }

    /// The field of this number; none where the format has none.
    pub(super) fn field(self, number: i16) -> Option<Self> {
        let Struct(fields) = self else { return None };
        fields.iter().find(|(of, _)| *of == number).map(|(_, shape)| *shape)
    }
}

/// `FileMetaData`.
pub(super) const FOOTER: Shape = Struct(&[
    (1, Number),
    (2, List(&SCHEMA_ELEMENT)),
    (3, Number),
    (4, List(&ROW_GROUP)),
    (5, List(&KEY_VALUE)),
    (6, Bytes),
    (7, List(&COLUMN_ORDER)),
]);

/// `PageHeader`.
pub(super) const PAGE_HEADER: Shape = Struct(&[
    (1, Number),
    (2, Number),
    (3, Number),
    (4, Number),
    (5, DATA_PAGE),
    (6, EMPTY),
    (7, DICTIONARY_PAGE),
    (8, DATA_PAGE_V2),
]);

const DATA_PAGE: Shape = Struct(&[(1, Number), (2, Number), (3, Number), (4, Number), (5, STATISTICS)]);

const DATA_PAGE_V2: Shape = Struct(&[
    (1, Number),
    (2, Number),
    (3, Number),
    (4, Number),
    (5, Number),
    (6, Number),
    (7, Flag),
    (8, STATISTICS),
]);

const DICTIONARY_PAGE: Shape = Struct(&[(1, Number), (2, Number), (3, Flag)]);

const SCHEMA_ELEMENT: Shape = Struct(&[
    (1, Number),
    (2, Number),
    (3, Number),
    (4, Bytes),
    (5, Number),
    (6, Number),
    (7, Number),
    (8, Number),
    (9, Number),
    (10, LOGICAL_TYPE),
]);

const LOGICAL_TYPE: Shape = Struct(&[
    (1, EMPTY),
    (2, EMPTY),
    (3, EMPTY),
    (4, EMPTY),
    // Decimal.
    (5, Struct(&[(1, Number), (2, Number)])),
    (6, EMPTY),
    (7, TIME),
    (8, TIME),
    // Integer.
    (10, Struct(&[(1, Byte), (2, Flag)])),
    (11, EMPTY),
    (12, EMPTY),
    (13, EMPTY),
    (14, EMPTY),
    (15, EMPTY),
    // Variant, geometry, geography.
    (16, Struct(&[(1, Byte)])),
    (17, Struct(&[(1, Bytes)])),
    (18, Struct(&[(1, Bytes), (2, Number)])),
    (19, EMPTY),
]);

const TIME: Shape = Struct(&[(1, Flag), (2, Struct(&[(1, EMPTY), (2, EMPTY), (3, EMPTY)]))]);

const ROW_GROUP: Shape = Struct(&[
    (1, List(&COLUMN_CHUNK)),
    (2, Number),
    (3, Number),
    // Columns it is sorted by.
    (4, List(&Struct(&[(1, Number), (2, Flag), (3, Flag)]))),
    (5, Number),
    (6, Number),
    (7, Number),
]);

const COLUMN_CHUNK: Shape =
    Struct(&[(1, Bytes), (2, Number), (3, COLUMN), (4, Number), (5, Number), (6, Number), (7, Number)]);

const COLUMN: Shape = Struct(&[
    (1, Number),
    (2, List(&Number)),
    (3, List(&Bytes)),
    (4, Number),
    (5, Number),
    (6, Number),
    (7, Number),
    (8, List(&KEY_VALUE)),
    (9, Number),
    (10, Number),
    (11, Number),
    (12, STATISTICS),
    // Encodings of its pages.
    (13, List(&Struct(&[(1, Number), (2, Number), (3, Number)]))),
    (14, Number),
    (15, Number),
    // Sizes.
    (16, Struct(&[(1, Number), (2, List(&Number)), (3, List(&Number))])),
    // Where on Earth.
    (17, Struct(&[(1, BOUNDING_BOX), (2, List(&Number))])),
]);

const STATISTICS: Shape = Struct(&[
    (1, Bytes),
    (2, Bytes),
    (3, Number),
    (4, Number),
    (5, Bytes),
    (6, Bytes),
    (7, Flag),
    (8, Flag),
    (9, Number),
]);

const BOUNDING_BOX: Shape = Struct(&[
    (1, Double),
    (2, Double),
    (3, Double),
    (4, Double),
    (5, Double),
    (6, Double),
    (7, Double),
    (8, Double),
]);

const COLUMN_ORDER: Shape = Struct(&[(1, EMPTY), (2, EMPTY), (3, EMPTY)]);

const KEY_VALUE: Shape = Struct(&[(1, Bytes), (2, Bytes)]);

const EMPTY: Shape = Struct(&[]);
