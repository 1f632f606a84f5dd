//! What the paper's Table 1 says: eight controllers, three records, their gains and figures.

/// One of the three records of Table 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Event {
    /// Kobe 1995, near field.
    Kobe,
    /// El Centro 1940.
    ElCentro,
    /// Taft 1952.
    Taft,
}

impl Event {
    /// In the order of the table.
    pub const ALL: [Self; 3] = [Self::Kobe, Self::ElCentro, Self::Taft];

    /// Name as the table writes it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Kobe => "Kobe",
            Self::ElCentro => "El Centro",
            Self::Taft => "Taft",
        }
    }

    /// Peak of the paper's reference acceleration, g.
    pub fn reference_peak_g(self) -> f64 {
        match self {
            Self::Kobe => 0.740,
            Self::ElCentro => 0.280,
            Self::Taft => 0.132,
        }
    }
}

/// One of the eight controllers of Table 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Named {
    /// Displacement feedback with the gains that were in use.
    Current,
    /// Displacement feedback with strong gains.
    Strong,
    /// Acceleration and displacement feedback.
    AccDisp,
    /// The same with integral gain on the acceleration.
    AccDisp2,
    /// Velocity and displacement feedback.
    VeloDisp,
    /// All three.
    VeloDispAcc,
    /// Velocity and acceleration feedback.
    VeloAcc,
    /// Strong displacement feedback of the record modified by Eq. 10.
    Modified,
}

/// Proportional (1) and integral (1/s) gains of the three loops of Fig. 12.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PublishedGains {
    /// On the displacement error.
    pub displacement: (f64, f64),
    /// On the acceleration error, integrated twice.
    pub acceleration: (f64, f64),
    /// On the velocity error, integrated once.
    pub velocity: (f64, f64),
}

/// The figures of one row.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Figures {
    /// Acceleration error of Eq. 11, as printed.
    pub e_a: f64,
    /// Displacement error of Eq. 12, as printed.
    pub e_d: f64,
    /// Peak acceleration of the table, g.
    pub peak_g: f64,
}

impl Named {
    /// In the order of the table.
    pub const ALL: [Self; 8] = [
        Self::Current,
        Self::Strong,
        Self::AccDisp,
        Self::AccDisp2,
        Self::VeloDisp,
        Self::VeloDispAcc,
        Self::VeloAcc,
        Self::Modified,
    ];

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Current => "current",
            Self::Strong => "strong",
            Self::AccDisp => "acc-disp",
            Self::AccDisp2 => "acc-disp-2",
            Self::VeloDisp => "velo-disp",
            Self::VeloDispAcc => "velo-disp-acc",
            Self::VeloAcc => "velo-acc",
            Self::Modified => "modified",
        }
    }

    /// Name in tables.
    pub fn title(self) -> &'static str {
        match self {
            Self::Current => "Current",
            Self::Strong => "Strong",
            Self::AccDisp => "Acc-Disp",
            Self::AccDisp2 => "Acc-Disp-2",
            Self::VeloDisp => "Velo-Disp",
            Self::VeloDispAcc => "Velo-Disp-Acc",
            Self::VeloAcc => "Velo-Acc",
            Self::Modified => "Modified",
        }
    }

    /// The controller of this name, as [`Named::name`] writes it.
    pub fn parse(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|named| named.name() == name)
    }

    /// Gains of Table 1. The scan repeats columns; `velo-disp` reads velocity I = 0 or 1: the first six columns, which
    /// hold for every other row, say 0.
    pub fn gains(self) -> PublishedGains {
        let (off, strong) = ((0.0, 0.0), (10.0, 1.0));
        let gains = |displacement, acceleration, velocity| PublishedGains { displacement, acceleration, velocity };
        match self {
            Self::Current => gains((3.70205, 0.61701), off, off),
            Self::Strong | Self::Modified => gains(strong, off, off),
            Self::AccDisp => gains(strong, (10.0, 0.0), off),
            Self::AccDisp2 => gains(strong, strong, off),
            Self::VeloDisp => gains(strong, off, (10.0, 0.0)),
            Self::VeloDispAcc => gains(strong, strong, strong),
            Self::VeloAcc => gains(off, strong, strong),
        }
    }

    /// The paper's figures for this controller and record.
    pub fn published(self, event: Event) -> Figures {
        let [kobe, el_centro, taft] = match self {
            Self::Current => [[0.304, 0.300, 0.506], [0.280, 0.061, 0.164], [0.261, 0.030, 0.080]],
            Self::Strong => [[0.636, 0.152, 1.375], [0.087, 0.012, 0.419], [0.041, 0.005, 0.134]],
            Self::AccDisp => [[0.235, 0.326, 0.724], [0.162, 0.201, 0.198], [0.179, 0.201, 0.092]],
            Self::AccDisp2 => [[0.243, 0.416, 0.723], [0.162, 0.200, 0.199], [0.179, 0.201, 0.092]],
            Self::VeloDisp => [[1.118, 0.122, 1.675], [0.341, 0.003, 0.803], [0.106, 0.001, 0.166]],
            Self::VeloDispAcc => [[0.594, 0.198, 1.602], [0.096, 0.088, 0.246], [0.109, 0.089, 0.117]],
            Self::VeloAcc => [[0.250, 0.418, 0.872], [0.205, 0.200, 0.211], [0.175, 0.200, 0.102]],
            Self::Modified => [[0.058, 0.053, 0.657], [0.013, 0.010, 0.282], [0.028, 0.005, 0.134]],
        };
        let [e_a, e_d, peak_g] = match event {
            Event::Kobe => kobe,
            Event::ElCentro => el_centro,
            Event::Taft => taft,
        };
        Figures { e_a, e_d, peak_g }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_parses_to_itself() {
        for named in Named::ALL {
            assert_eq!(Named::parse(named.name()), Some(named));
        }
        assert_eq!(Named::parse("Current"), None);
    }
}
