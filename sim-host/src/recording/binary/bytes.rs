//! A file's bytes read piece by piece; an end before its time is a flaw and no panic.

/// What is wrong with a file's bytes, in words.
pub(crate) type Flaw = String;

/// Order of the bytes of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Order {
    /// The lowest first.
    Little,
    /// The highest first.
    Big,
}

/// Bytes and how far they are read.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Bytes<'a> {
    all: &'a [u8],
    at: usize,
    order: Order,
}

impl<'a> Bytes<'a> {
    /// All of a file's bytes, from the first on.
    pub(crate) fn new(all: &'a [u8], order: Order) -> Self {
        Self { all, at: 0, order }
    }

    /// How many bytes are read.
    pub(crate) fn position(&self) -> usize {
        self.at
    }

    /// The order of the numbers.
    pub(crate) fn order(&self) -> Order {
        self.order
    }

    /// From here on numbers come in this order.
    pub(crate) fn ordered(mut self, order: Order) -> Self {
        self.order = order;
        self
    }

    /// The next bytes.
    pub(crate) fn take(&mut self, count: usize) -> Result<&'a [u8], Flaw> {
        let end = self.at.checked_add(count).filter(|end| *end <= self.all.len());
        let end = end.ok_or_else(|| format!("is cut off: {count} bytes are expected at byte {}", self.at))?;
        let bytes = &self.all[self.at..end];
        self.at = end;
        Ok(bytes)
    }

    /// Reads on from another place.
    pub(crate) fn seek(&mut self, to: usize) -> Result<(), Flaw> {
        if to > self.all.len() {
            return Err(format!("is cut off: it ends before byte {to}"));
        }
        self.at = to;
        Ok(())
    }

    /// An unsigned number of four bytes.
    pub(crate) fn u32(&mut self) -> Result<u32, Flaw> {
        Ok(u32_of(self.take(4)?, self.order))
    }

    /// An unsigned number of eight bytes.
    pub(crate) fn u64(&mut self) -> Result<u64, Flaw> {
        Ok(u64_of(self.take(8)?, self.order))
    }
}

fn padded<const N: usize>(bytes: &[u8], order: Order) -> [u8; N] {
    let mut all = [0; N];
    for (to, from) in all.iter_mut().zip(bytes) {
        *to = *from;
    }
    if order == Order::Big {
        all.reverse();
    }
    all
}

/// The first two bytes as a number.
pub(crate) fn u16_of(bytes: &[u8], order: Order) -> u16 {
    u16::from_le_bytes(padded(bytes, order))
}

/// The first four bytes as a number.
pub(crate) fn u32_of(bytes: &[u8], order: Order) -> u32 {
    u32::from_le_bytes(padded(bytes, order))
}

/// The first eight bytes as a number.
pub(crate) fn u64_of(bytes: &[u8], order: Order) -> u64 {
    u64::from_le_bytes(padded(bytes, order))
}
