//! `--shard I/N`: one piece of a campaign.

use std::str::FromStr;

/// One piece of several.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Shard {
    /// Which, from 1.
    pub(crate) number: u64,
    /// Of how many.
    pub(crate) of: u64,
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wanted = || format!("'{text}' is no piece: give I/N with 1 <= I <= N, for instance 3/8");
        let (number, of) = text.split_once('/').ok_or_else(wanted)?;
        let shard = Self { number: number.parse().map_err(|_| wanted())?, of: of.parse().map_err(|_| wanted())? };
        if shard.number < 1 || shard.number > shard.of { Err(wanted()) } else { Ok(shard) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_piece_is_one_of_its_number() {
        assert!("3/8".parse::<Shard>().is_ok_and(|shard| (shard.number, shard.of) == (3, 8)));
        for wrong in ["0/8", "9/8", "3", "a/b", "1/0"] {
            assert!(wrong.parse::<Shard>().is_err(), "{wrong}");
        }
    }
}
