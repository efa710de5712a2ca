//! WebP files whose containers lie (WebP container specification; RFC 9649).

use anyhow::Result;

use super::bytes::put;
use super::list::Files;
use super::list::Right::{Any, Refuse};
use super::seeds;
use crate::chance::Chance;

const LIES: &str = "header lies";
const LARGE: &str = "header too large";

pub(crate) fn add(files: &mut Files) -> Result<()> {
    let seed = seeds::image("webp")?;
    let add = |files: &mut Files, kind, right, name: &str, bytes: Vec<u8>| {
        files.image(kind, right, &format!("{name}.webp"), bytes);
    };
    // RIFF, its size, WEBP, VP8L, its size, 0x2f, the size of the image.
    for size in [0, 4, 11, 0x7fff_ffff, u32::MAX] {
        let bytes = put(&seed, 4, &size.to_le_bytes());
        add(files, LIES, Any, &format!("riff-size-{size}"), bytes);
    }
    // A chunk too small for its image is read on by libwebp; one larger than its container is not whole.
    for (size, right) in [(0, Any), (3, Any), (0x7fff_ffff, Refuse), (u32::MAX, Refuse)] {
        let bytes = put(&seed, 16, &u32::to_le_bytes(size));
        add(files, LIES, right, &format!("chunk-size-{size}"), bytes);
    }
    add(files, LIES, Refuse, "wrong-signature-byte", put(&seed, 20, &[0x2e]));
    add(files, LIES, Refuse, "version-7", put(&seed, 24, &[seed[24] | 0xe0]));
    add(files, LIES, Refuse, "unknown-chunk-alone", put(&seed, 12, b"ABCD"));
    add(files, LIES, Refuse, "lossless-said-to-be-lossy", put(&seed, 12, b"VP8 "));
    add(files, LIES, Refuse, "no-chunk", riff(&[]));
    add(files, "damaged data", Any, "noise-for-data", {
        let noise = Chance(12).bytes(seed.len() - 25);
        put(&seed, 25, &noise)
    });
    // 14 bits a side, less one: 16384x16384 and 16384x1, of hardly any data.
    add(files, LARGE, Refuse, "16384x16384", riff(&[(b"VP8L", b"\x2f\xff\xff\xff\x0f\0\0\0")]));
    add(files, LARGE, Refuse, "16384x1", riff(&[(b"VP8L", b"\x2f\xff\x3f\0\0\0\0")]));
    // Codes of one symbol take no bits, so that this is the whole of a black image.
    add(files, LARGE, Any, "whole-16384x16384", riff(&[(b"VP8L", b"\x2f\xff\xff\xff\x0f\x88\x88\x08")]));
    let lossy = |size: [u8; 4]| [&b"\x30\x01\0\x9d\x01\x2a"[..], &size, &[0; 9]].concat();
    add(files, LARGE, Refuse, "lossy-16383x16383", riff(&[(b"VP8 ", &lossy([0xff, 0x3f, 0xff, 0x3f]))]));
    add(files, LIES, Refuse, "lossy-0x0", riff(&[(b"VP8 ", &lossy([0; 4]))]));
    add(
        files,
        LIES,
        Refuse,
        "lossy-without-start-code",
        riff(&[(b"VP8 ", &[0x30, 1, 0, 1, 2, 3, 48, 0, 32, 0])]),
    );
    // The extended header: flags, three bytes unused, sides less one in 24 bits.
    let inner = &seed[20..];
    let extended = |flags: u8, size: [u8; 6]| [&[flags, 0, 0, 0][..], &size].concat();
    let huge = extended(0, [0xff; 6]);
    add(files, LARGE, Refuse, "canvas-16777216x16777216", riff(&[(b"VP8X", &huge), (b"VP8L", &inner[..8])]));
    add(files, LARGE, Any, "canvas-65536x65535-small-picture", {
        riff(&[(b"VP8X", &extended(0, [0xff, 0xff, 0, 0xfe, 0xff, 0])), (b"VP8L", inner)])
    });
    add(files, LIES, Refuse, "animation-without-frames", {
        riff(&[(b"VP8X", &extended(2, [47, 0, 0, 31, 0, 0])), (b"ANIM", &[0; 6])])
    });
    add(files, LIES, Refuse, "animation-with-an-empty-frame", {
        let chunks: [(&[u8; 4], &[u8]); 3] =
            [(b"VP8X", &extended(2, [47, 0, 0, 31, 0, 0])), (b"ANIM", &[0; 6]), (b"ANMF", &[0xff; 16])];
        riff(&chunks)
    });
    add(
        files,
        LIES,
        Refuse,
        "extended-header-alone",
        riff(&[(b"VP8X", &extended(0x3e, [47, 0, 0, 31, 0, 0]))]),
    );
    add(files, LIES, Refuse, "short-extended-header", riff(&[(b"VP8X", &[0; 3])]));
    add(files, LIES, Refuse, "transparency-alone", {
        riff(&[(b"VP8X", &extended(0x10, [47, 0, 0, 31, 0, 0])), (b"ALPH", &[0; 40])])
    });
    add(files, LIES, Refuse, "container-alone", b"RIFF\0\0\0\0WEBP".to_vec());
    Ok(())
}

fn riff(chunks: &[(&[u8; 4], &[u8])]) -> Vec<u8> {
    let mut body = b"WEBP".to_vec();
    for (name, data) in chunks {
        body.extend_from_slice(*name);
        body.extend((data.len() as u32).to_le_bytes());
        body.extend_from_slice(data);
        body.resize(body.len().next_multiple_of(2), 0);
    }
    [b"RIFF", &(body.len() as u32).to_le_bytes()[..], &body].concat()
}
