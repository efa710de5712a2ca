//! Whether the system has memory to give.

/// Whether the system has so many bytes for us. They are asked for and given back at once, so that what is too large is an
/// error of its file, and not the end of the process.
pub(crate) fn is_memory(bytes: u64) -> bool {
    let mut memory = Vec::<u8>::new();
    let is_memory = usize::try_from(bytes).is_ok_and(|bytes| memory.try_reserve_exact(bytes).is_ok());
    // The compiler must not leave out memory that nobody uses.
    std::hint::black_box(&memory);
    is_memory
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_little_memory_is_there_and_all_of_an_address_space_is_not() {
        assert!(is_memory(1 << 20));
        assert!(!is_memory(u64::MAX) && !is_memory(u64::MAX / 4));
    }
}
