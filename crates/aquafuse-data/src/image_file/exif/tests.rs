use super::*;
use proptest::prelude::*;

/// A block in either byte order: orientation, a description, an EXIF directory with one rational, a thumbnail's link.
fn block(little: bool, orientation: u16) -> Vec<u8> {
    let short = |v: u16| if little { v.to_le_bytes() } else { v.to_be_bytes() };
    let long = |v: u32| if little { v.to_le_bytes() } else { v.to_be_bytes() };
    let entry = |tag: u16, kind: u16, count: u32, value: [u8; 4]| {
        [&short(tag)[..], &short(kind), &long(count), &value].concat()
    };
    let [a, b] = short(orientation);
    [
        if little { &b"II"[..] } else { b"MM" },
        &short(42),
        &long(8),
        &short(3),
        &entry(0x010e, 2, 8, long(50)),
        &entry(0x0112, 3, 1, [a, b, 0, 0]),
        &entry(0x8769, 4, 1, long(58)),
        &long(4000),
        b"a wreck\0",
        &short(1),
        &entry(0x829a, 5, 1, long(76)),
        &long(0),
        &long(1),
        &long(250),
    ]
    .concat()
}

#[test]
fn orientation_is_read_in_both_byte_orders() {
    for little in [true, false] {
        for value in 1..=8 {
            assert_eq!(orientation(&block(little, value)), value as u8);
        }
        assert_eq!(orientation(&block(little, 9)), 1, "there is no such orientation");
    }
    assert_eq!(orientation(b"no block"), 1);
}

#[test]
fn upright_changes_the_orientation_and_nothing_else() {
    for little in [true, false] {
        let mut changed = block(little, 6);
        set_upright(&mut changed);
        assert_eq!(changed, block(little, 1));
    }
}

#[test]
fn fields_survive_the_way_into_a_block_of_this_machine() {
    let [little, big] = [true, false].map(|little| Exif::read(&block(little, 6)).unwrap());
    assert_eq!(little, big);
    let back = Exif::read(&little.to_block().unwrap()).unwrap();
    assert_eq!(back, little);
    let (tag, inner) = &back.inner[0];
    let numbers: Vec<u8> = [1_u32, 250].into_iter().flat_map(u32::to_ne_bytes).collect();
    assert_eq!((*tag, inner.fields[0].tag, &inner.fields[0].bytes), (0x8769, 0x829a, &numbers));
}

#[test]
fn a_note_stands_after_the_description() {
    let text = |block: &[u8]| {
        let fields = Exif::read(block).unwrap().fields;
        String::from_utf8(fields.into_iter().find(|field| field.tag == DESCRIPTION).unwrap().bytes).unwrap()
    };
    assert_eq!(text(&with_description(Some(&block(false, 6)), "cut short").unwrap()), "a wreck; cut short\0");
    assert_eq!(text(&with_description(None, "cut short").unwrap()), "cut short\0");
    let marked = with_description(Some(&block(true, 6)), "x").unwrap();
    assert_eq!(orientation(&marked), 6);
}

#[test]
fn the_thumbnail_is_no_longer_found() {
    for little in [true, false] {
        let mut changed = block(little, 6);
        unlink_thumbnail(&mut changed);
        assert_eq!(changed[46..50], [0; 4]);
        assert_eq!(Exif::read(&changed), Exif::read(&block(little, 6)));
    }
}

#[test]
fn fields_that_point_to_the_same_bytes_do_not_grow_without_end() {
    let entry =
        |tag: u16| [&tag.to_le_bytes()[..], &7_u16.to_le_bytes(), &4000_u32.to_le_bytes(), &[0; 4]].concat();
    let entries: Vec<u8> = (0..300).flat_map(|i| entry(0x9000 + i)).collect();
    let block = [&b"II*\0\x08\0\0\0"[..], &300_u16.to_le_bytes(), &entries, &[0; 4]].concat();
    assert_eq!(Exif::read(&block), None, "a million bytes out of four thousand");
}

#[test]
fn the_resolution_of_an_image_on_its_side_is_exchanged() {
    let resolution = Resolution { density: (300.0, 150.0), unit: ResolutionUnit::Inch };
    let ratio = |value: u32| [value.to_ne_bytes(), 1_u32.to_ne_bytes()].concat();
    let field = |tag, value| Field { tag, kind: Type::RATIONAL, bytes: ratio(value) };
    let exif = Exif { fields: vec![field(X_RESOLUTION, 300), field(Y_RESOLUTION, 150)], inner: Vec::new() };
    let mut block = exif.to_block().unwrap();
    assert_eq!(Exif::read(&block).unwrap().resolution(), Some(resolution));
    exchange_resolution(&mut block);
    assert_eq!(Exif::read(&block).unwrap().resolution().unwrap().density, (150.0, 300.0));
}

#[test]
fn a_loop_of_directories_ends() {
    let mut looped = block(true, 1);
    // The EXIF directory is the main one.
    looped[42..46].copy_from_slice(&8_u32.to_le_bytes());
    assert!(Exif::read(&looped).is_some());
}

proptest! {
    #[test]
    fn no_block_makes_it_panic(little: bool, flips in prop::collection::vec((0..84_usize, any::<u8>()), 0..12), cut in 0..84_usize) {
        let mut block = block(little, 3);
        for (at, value) in flips {
            block[at] = value;
        }
        block.truncate(cut + 1);
        let _ = (orientation(&block), Exif::read(&block).map(|exif| exif.to_block()));
        unlink_thumbnail(&mut block);
        set_upright(&mut block);
        let _ = with_description(Some(&block), "note");
    }
}
