//! TIFF whose strips or tiles are JPEG streams.

use jpeg_encoder::{ColorType, Encoder, SamplingFactor};

use super::*;

const WIDTH: usize = 48;
const HEIGHT: usize = 40;

/// A TIFF with these fields and pieces; its pieces are tiles where the fields have the size of tiles.
pub(super) fn jpeg_in_tiff(fields: &[(u16, u32)], pieces: &[&[u8]], tables: &[u8]) -> Vec<u8> {
    let tags = if fields.iter().any(|(tag, _)| *tag == 322) { [324, 325] } else { [273, 279] };
    let count = fields.len() + 2 + usize::from(!tables.is_empty());
    let mut body = 8 + 2 + 12 * count + 4;
    let mut place = |bytes: usize| {
        body += bytes;
        (body - bytes) as u32
    };
    let firsts: Vec<u32> = pieces.iter().map(|piece| place(piece.len())).collect();
    let lengths: Vec<u32> = pieces.iter().map(|piece| piece.len() as u32).collect();
    let array = |values: &[u32], place: &mut dyn FnMut(usize) -> u32| match values {
        [one] => *one,
        many => place(4 * many.len()),
    };
    let (first, length) = (array(&firsts, &mut place), array(&lengths, &mut place));
    let pieces_count = pieces.len() as u32;
    let mut all: Vec<(u16, u16, u32, u32)> = fields.iter().map(|(tag, value)| (*tag, 4, 1, *value)).collect();
    all.extend([(tags[0], 4, pieces_count, first), (tags[1], 4, pieces_count, length)]);
    if !tables.is_empty() {
        all.push((347, 7, tables.len() as u32, place(tables.len())));
    }
    all.sort_unstable();
    let mut file = [&b"II*\0\x08\0\0\0"[..], &(count as u16).to_le_bytes()].concat();
    for (tag, kind, number, value) in all {
        file.extend(
            [&tag.to_le_bytes()[..], &kind.to_le_bytes(), &number.to_le_bytes(), &value.to_le_bytes()]
                .concat(),
        );
    }
    file.extend([0; 4]);
    file.extend(pieces.concat());
    if pieces.len() > 1 {
        file.extend([firsts, lengths].concat().into_iter().flat_map(u32::to_le_bytes));
    }
    file.extend(tables);
    file
}

fn colour(column: usize, row: usize) -> [u8; 3] {
    [column * 4, 240 - row * 3, 90 + column / 8 * 9].map(|value| value as u8)
}

/// The piece that begins at a pixel, as a JPEG of these components.
fn piece(corner: [usize; 2], size: [usize; 2], components: ColorType) -> Vec<u8> {
    let grey = components == ColorType::Luma;
    let pixel = |i: usize| {
        let colour = colour(corner[0] + i % size[0], corner[1] + i / size[0]);
        colour.into_iter().take(if grey { 1 } else { 3 })
    };
    let samples: Vec<u8> = (0..size[0] * size[1]).flat_map(pixel).collect();
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, 95);
    encoder.set_sampling_factor(SamplingFactor::F_1_1);
    encoder.encode(&samples, size[0] as u16, size[1] as u16, components).unwrap();
    bytes
}

/// The segments of a JPEG's head that are tables, as a stream, and the JPEG without them and without those of an application.
fn without_tables(jpeg: &[u8]) -> (Vec<u8>, Vec<u8>) {
    let (mut tables, mut rest, mut at) = (vec![0xff, 0xd8], vec![0xff, 0xd8], 2);
    while jpeg[at + 1] != 0xda {
        let end = at + 2 + usize::from(u16::from_be_bytes([jpeg[at + 2], jpeg[at + 3]]));
        match jpeg[at + 1] {
            0xdb | 0xc4 => tables.extend(&jpeg[at..end]),
            0xe0..=0xef => {}
            _ => rest.extend(&jpeg[at..end]),
        }
        at = end;
    }
    rest.extend(&jpeg[at..]);
    (tables, rest)
}

/// The largest difference of a decoded image from [`colour`].
fn worst(image: &Image<u8>, grey: bool) -> u8 {
    let expected = (0..WIDTH * HEIGHT).flat_map(|i| {
        let colour = colour(i % WIDTH, i / WIDTH);
        if grey { [colour[0]; 3] } else { colour }
    });
    image.as_raw().iter().zip(expected).map(|(found, wanted)| found.abs_diff(wanted)).max().unwrap()
}

#[test]
fn strips_and_tiles_of_every_colour_are_read_with_and_without_tables() {
    let fields = |colours: u32, samples: u32, more: &[(u16, u32)]| {
        let page =
            [(256, WIDTH as u32), (257, HEIGHT as u32), (258, 8), (259, 7), (262, colours), (277, samples)];
        [&page[..], more].concat()
    };
    let name = Path::new("a.tiff");
    for (colours, samples, components) in
        [(6, 3, ColorType::Rgb), (2, 3, ColorType::Ycbcr), (1, 1, ColorType::Luma)]
    {
        // Strips of 16 rows, the last of 8; tiles of 32 x 32, padded.
        let strips: Vec<Vec<u8>> =
            [(0, 16), (16, 16), (32, 8)].map(|(row, rows)| piece([0, row], [WIDTH, rows], components)).into();
        let corners = [[0, 0], [32, 0], [0, 32], [32, 32]];
        let tiles: Vec<Vec<u8>> = corners.map(|corner| piece(corner, [32, 32], components)).into();
        for (pieces, more) in [(strips, &[(278, 16)][..]), (tiles, &[(322, 32), (323, 32)])] {
            let fields = fields(colours, samples, more);
            let taken: Vec<(Vec<u8>, Vec<u8>)> = pieces.iter().map(|piece| without_tables(piece)).collect();
            let mut tables = taken[0].0.clone();
            tables.extend([0xff, 0xd9]);
            let bare: Vec<&[u8]> = taken.iter().map(|(_, rest)| &rest[..]).collect();
            let abbreviated = jpeg_in_tiff(&fields, &bare, &tables);
            let read = |bytes: &[u8]| ImageFile::from_bytes(name, bytes, &ReadOptions::default()).unwrap();
            let image = read(&abbreviated).pixels.into_bytes();
            assert!(worst(&image, samples == 1) <= 8, "{colours}, {more:?}: {}", worst(&image, samples == 1));
            if colours != 2 {
                // Whole files, as some programs write them; that three components are RGB they cannot say.
                let whole: Vec<&[u8]> = pieces.iter().map(|piece| &piece[..]).collect();
                assert_eq!(read(&jpeg_in_tiff(&fields, &whole, &[])).pixels.into_bytes(), image);
            }
        }
    }
}

#[test]
fn a_piece_that_is_missing_cut_short_or_beyond_the_end_is_named() {
    let strips = [piece([0, 0], [WIDTH, 32], ColorType::Rgb), piece([0, 32], [WIDTH, 8], ColorType::Rgb)];
    let fields =
        [(256, WIDTH as u32), (257, HEIGHT as u32), (258, 8), (259, 7), (262, 6), (277, 3), (278, 32)];
    let read = |bytes: &[u8]| ImageFile::from_bytes(Path::new("a.tiff"), bytes, &ReadOptions::default());
    let whole = jpeg_in_tiff(&fields, &[&strips[0], &strips[1]], &[]);
    assert!(read(&whole).is_ok());
    let short = &strips[1][..strips[1].len() / 2];
    for (file, cause) in [
        (jpeg_in_tiff(&fields, &[&strips[0]], &[]), "inconsistent sizes"),
        (jpeg_in_tiff(&fields, &[&strips[0], short], &[]), "strip or tile 1"),
        (jpeg_in_tiff(&fields, &[&strips[0], b"text"], &[]), "strip or tile 1 is no JPEG"),
        (whole[..whole.len() - strips[1].len()].to_vec(), ""),
    ] {
        let said = read(&file).unwrap_err().to_string();
        assert!(said.contains(cause), "{said}");
    }
}
