//! Small tools for bytes: chance, checksums, streams that inflate, edits.

/// SplitMix64: the same numbers on every machine.
pub(crate) struct Chance(pub(crate) u64);

impl Chance {
    pub(crate) fn next(&mut self) -> u64 {
        aquafuse::random::split_mix(&mut self.0)
    }

    pub(crate) fn below(&mut self, limit: usize) -> usize {
        (self.next() % limit.max(1) as u64) as usize
    }

    pub(crate) fn bytes(&mut self, count: usize) -> Vec<u8> {
        (0..count).map(|_| self.next() as u8).collect()
    }
}

/// The checksum of PNG chunks.
pub(crate) fn crc32(bytes: &[u8]) -> u32 {
    let mut crc = u32::MAX;
    for &byte in bytes {
        crc ^= u32::from(byte);
        for _ in 0..8 {
            crc = if crc & 1 == 1 { (crc >> 1) ^ 0xedb8_8320 } else { crc >> 1 };
        }
    }
    !crc
}

fn adler32(bytes: &[u8]) -> u32 {
    let (a, b) = bytes.iter().fold((1, 0), |(a, b), &byte| {
        let a = (a + u32::from(byte)) % 65521;
        (a, (b + a) % 65521)
    });
    b << 16 | a
}

/// A zlib stream that holds its bytes as they are, in blocks of at most 65,535.
pub(crate) fn zlib(raw: &[u8]) -> Vec<u8> {
    let mut stream = vec![0x78, 0x01];
    let blocks: Vec<&[u8]> = if raw.is_empty() { vec![raw] } else { raw.chunks(65_535).collect() };
    for (index, block) in blocks.iter().enumerate() {
        let length = block.len() as u16;
        stream.push(u8::from(index + 1 == blocks.len()));
        stream.extend(length.to_le_bytes());
        stream.extend((!length).to_le_bytes());
        stream.extend_from_slice(block);
    }
    stream.extend(adler32(raw).to_be_bytes());
    stream
}

/// A zlib stream that inflates to at least `least` zeros from a 150th of that.
///
/// One zero, then as often as needed "the last byte, 258 times", in the fixed code: 13 bits each.
pub(crate) fn zlib_zeros(least: usize) -> Vec<u8> {
    let mut bits = Bits::least_first();
    bits.put(0b011, 3); // the last block, fixed code
    bits.put_code(0b0011_0000, 8); // a zero
    let repeats = least.div_ceil(258);
    for _ in 0..repeats {
        bits.put_code(0b1100_0101, 8); // length 258
        bits.put_code(0, 5); // distance 1
    }
    bits.put_code(0, 7); // end
    let mut stream = vec![0x78, 0x01];
    stream.extend(bits.finish());
    // Adler-32 of zeros: the first sum stays 1, the second counts the bytes.
    let count = (repeats * 258 + 1) % 65521;
    stream.extend(((count as u32) << 16 | 1).to_be_bytes());
    stream
}

/// Bits into bytes, the lowest of a byte first, as deflate has them.
struct Bits {
    bytes: Vec<u8>,
    current: u32,
    count: u32,
}

impl Bits {
    fn least_first() -> Self {
        Self { bytes: Vec::new(), current: 0, count: 0 }
    }

    fn put(&mut self, value: u32, count: u32) {
        self.current |= value << self.count;
        self.count += count;
        while self.count >= 8 {
            self.bytes.push(self.current as u8);
            self.current >>= 8;
            self.count -= 8;
        }
    }

    /// Huffman codes stand with their highest bit first.
    fn put_code(&mut self, code: u32, count: u32) {
        self.put(code.reverse_bits() >> (32 - count), count);
    }

    fn finish(mut self) -> Vec<u8> {
        if self.count > 0 {
            self.bytes.push(self.current as u8);
        }
        self.bytes
    }
}

/// Writes `new` over what stands at `at`.
pub(crate) fn put(bytes: &[u8], at: usize, new: &[u8]) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    bytes.splice(at..(at + new.len()).min(bytes.len()), new.iter().copied());
    bytes
}

/// Where `needle` first stands.
pub(crate) fn find(bytes: &[u8], needle: &[u8]) -> Result<usize, String> {
    let at = bytes.windows(needle.len()).position(|window| window == needle);
    at.ok_or_else(|| format!("{} is not in the seed", String::from_utf8_lossy(needle)))
}
