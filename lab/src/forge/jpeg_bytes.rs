//! JPEG by hand: blocks of one grey each, so that a coder of twenty lines will do (ITU-T T.81).

/// A component: its sampling factors across and down.
pub(crate) type Sampling = (u8, u8);

pub(crate) const GREY: &[Sampling] = &[(1, 1)];
pub(crate) const COLOUR: &[Sampling] = &[(1, 1), (1, 1), (1, 1)];
pub(crate) const HALVED: &[Sampling] = &[(2, 2), (1, 1), (1, 1)];
pub(crate) const CMYK: &[Sampling] = &[(1, 1); 4];

/// The file between SOI and EOI.
pub(crate) fn file(parts: &[Vec<u8>]) -> Vec<u8> {
    [b"\xff\xd8", &parts.concat()[..], b"\xff\xd9"].concat()
}

/// A marker with its length and body.
pub(crate) fn segment(marker: u8, body: &[u8]) -> Vec<u8> {
    let length = (body.len() as u16 + 2).to_be_bytes();
    [&[0xff, marker], &length[..], body].concat()
}

/// DQT: every step is 8, so that the constant of a block is its grey less 128.
pub(crate) fn steps() -> Vec<u8> {
    segment(0xdb, &[&[0][..], &[8; 64]].concat())
}

/// DHT for constants: the sizes 0 to 8 in four bits each. And for the rest: "end of block", the bit 0.
pub(crate) fn codes() -> Vec<u8> {
    let mut constants = vec![0x00, 0, 0, 0, 9];
    constants.extend([0; 12]);
    constants.extend(0..9);
    let mut rest = vec![0x10, 1];
    rest.extend([0; 16]);
    segment(0xc4, &[constants, rest].concat())
}

/// SOF of any marker: 0xc0 is baseline, 0xc2 progressive.
pub(crate) fn frame(marker: u8, width: u16, height: u16, components: &[Sampling]) -> Vec<u8> {
    let mut body = vec![8];
    body.extend(height.to_be_bytes());
    body.extend(width.to_be_bytes());
    body.push(components.len() as u8);
    for (id, (across, down)) in (1..).zip(components) {
        body.extend([id, across << 4 | down, 0]);
    }
    segment(marker, &body)
}

/// SOS for components 1 to `count`, coefficients `from` to `to`.
pub(crate) fn scan_head(count: u8, from: u8, to: u8) -> Vec<u8> {
    let mut body = vec![count];
    body.extend((1..=count).flat_map(|id| [id, 0]));
    body.extend([from, to, 0]);
    segment(0xda, &body)
}

/// What a coded scan is made of.
pub(crate) struct Scan<'a> {
    pub(crate) components: &'a [Sampling],
    /// Units of all components, each with its blocks.
    pub(crate) units: usize,
    /// A restart marker after so many units; never if 0.
    pub(crate) restart: usize,
    /// Whether the end of each block is written: a progressive scan of constants has none.
    pub(crate) block_ends: bool,
}

impl Scan<'_> {
    pub(crate) fn bytes(&self) -> Vec<u8> {
        let mut bits = Bits::default();
        let mut before = vec![0; self.components.len()];
        for unit in 0..self.units {
            if self.restart > 0 && unit > 0 && unit % self.restart == 0 {
                bits.align();
                bits.bytes.extend([0xff, 0xd0 + (unit / self.restart - 1) as u8 % 8]);
                before.fill(0);
            }
            for (index, (across, down)) in self.components.iter().enumerate() {
                for block in 0..across * down {
                    let grey = (unit * 13 + index * 40 + usize::from(block) * 5) as i32 % 120 - 60;
                    bits.constant(grey - before[index]);
                    before[index] = grey;
                    if self.block_ends {
                        bits.put(0, 1);
                    }
                }
            }
        }
        bits.align();
        bits.bytes
    }
}

/// Bits into bytes, the highest first, with a zero stuffed after each 0xff.
#[derive(Default)]
struct Bits {
    bytes: Vec<u8>,
    current: u32,
    count: u32,
}

impl Bits {
    fn put(&mut self, value: u32, count: u32) {
        for at in (0..count).rev() {
            self.current = self.current << 1 | (value >> at & 1);
            self.count += 1;
            if self.count == 8 {
                self.bytes.push(self.current as u8);
                if self.current == 0xff {
                    self.bytes.push(0);
                }
                (self.current, self.count) = (0, 0);
            }
        }
    }

    /// The difference to the block before: its size in bits, then those bits.
    fn constant(&mut self, difference: i32) {
        let size = 32 - difference.unsigned_abs().leading_zeros();
        self.put(size, 4);
        let stored = if difference < 0 { difference - 1 } else { difference };
        self.put(stored as u32 & ((1 << size) - 1), size);
    }

    /// Fills the last byte with ones.
    fn align(&mut self) {
        while self.count > 0 {
            self.put(1, 1);
        }
    }
}

/// A whole baseline image of 48x32.
pub(crate) fn baseline(components: &[Sampling]) -> Vec<u8> {
    let mut parts = vec![steps(), codes(), frame(0xc0, 48, 32, components)];
    if components.len() == 4 {
        // Adobe's marker: these four are CMYK as they stand, not transformed.
        parts.insert(0, segment(0xee, b"Adobe\0\x64\0\0\0\0\0"));
    }
    parts.push(scan_head(components.len() as u8, 0, 63));
    parts.push(whole_scan(components));
    file(&parts)
}

/// The coded blocks of 48x32 pixels.
pub(crate) fn whole_scan(components: &[Sampling]) -> Vec<u8> {
    let side = components.iter().map(|(across, _)| usize::from(*across)).max().unwrap_or(1);
    Scan { components, units: 24 / (side * side), restart: 0, block_ends: true }.bytes()
}

/// A grey progressive image of `columns` by 8 blocks: constants first, then the rest, of which there is none.
pub(crate) fn progressive(columns: u16) -> Vec<u8> {
    let units = usize::from(columns) * 8;
    let constants = Scan { components: GREY, units, restart: 0, block_ends: false }.bytes();
    // "End of block" is the bit 0, and the last byte is filled with ones; 8 blocks a byte leave none to fill.
    let rest = vec![0; units / 8];
    file(&[
        steps(),
        codes(),
        frame(0xc2, 8 * columns, 64, GREY),
        scan_head(1, 0, 0),
        constants,
        scan_head(1, 1, 63),
        rest,
    ])
}
