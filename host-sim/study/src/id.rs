//! Names of cases: `family/seed`, then as far as they are there `/nuisance`, `/chosen` or `/advised` where the touches are those that
//! `truepath probe` chooses, with its own ball or the one it advises, and `/axis=value` where one thing was changed for a grid.

use std::fmt;
use std::str::FromStr;

use super::families::family;
use super::nuisance::Nuisance;
use super::seeds::Set;

/// What a grid changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, clap::ValueEnum)]
pub enum Axis {
    /// Probe noise.
    ///
    /// Its standard deviation, µm.
    Noise,
    /// Number of touches.
    Points,
    /// Mistakes of the job.
    ///
    /// As a multiple of the usual.
    Prior,
}

impl Axis {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Noise, Self::Points, Self::Prior];

    /// Its name in case ids and on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Noise => "noise",
            Self::Points => "points",
            Self::Prior => "prior",
        }
    }

    /// What it is, with its unit.
    pub const fn title(self) -> &'static str {
        match self {
            Self::Noise => "probe noise, µm (1 sigma)",
            Self::Points => "number of touches",
            Self::Prior => "mistakes of the job, times the usual",
        }
    }

    /// The values of the grid.
    pub const fn values(self) -> &'static [f64] {
        match self {
            Self::Noise => &[0.0, 1.0, 2.0, 3.0, 5.0, 7.0, 10.0],
            Self::Points => &[2.0, 3.0, 4.0, 6.0, 9.0, 12.0, 18.0, 30.0],
            Self::Prior => &[0.0, 0.5, 1.0, 1.5, 2.0, 3.0],
        }
    }
}

/// One cell of a grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    /// What is changed.
    pub axis: Axis,
    /// To what.
    pub value: f64,
}

/// Where the parts are touched.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, clap::ValueEnum, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Touches {
    /// Where the family says, a few more after the first correction.
    #[default]
    Family,
    /// Where `truepath probe` would touch: 8 places at 3 heights, every part alike.
    Chosen,
    /// There, and with the smaller ball that `truepath probe` advises where that of the job reaches the upper part of the wall only.
    Advised,
}

impl Touches {
    /// All of them, in the order of the tables.
    pub const ALL: [Self; 3] = [Self::Family, Self::Chosen, Self::Advised];

    /// Its name in case ids and on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Family => "family",
            Self::Chosen => "chosen",
            Self::Advised => "advised",
        }
    }

    /// How parts are touched, in words.
    pub const fn words(self) -> &'static str {
        match self {
            Self::Family => "where the family says",
            Self::Chosen => "where `truepath probe` chooses",
            Self::Advised => "where `truepath probe` chooses, with the ball that it advises",
        }
    }
}

/// Name of a case.
#[derive(Clone, Debug, PartialEq)]
pub struct CaseId {
    /// Name of the family.
    pub family: String,
    /// Seed.
    pub seed: u64,
    /// What is added to its machine.
    pub nuisance: Option<Nuisance>,
    /// Where its parts are touched.
    pub touches: Touches,
    /// The cell of a grid it belongs to.
    pub cell: Option<Cell>,
}

impl CaseId {
    /// The set of the seed.
    pub fn set(&self) -> Set {
        // Ids are made from the sets or checked when read.
        Set::of(self.seed).unwrap_or(Set::Random)
    }

    /// Whether it is the case of a family and a seed as it is.
    pub fn is_plain(&self) -> bool {
        self.nuisance.is_none() && self.touches == Touches::Family && self.cell.is_none()
    }
}

impl fmt::Display for CaseId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.family, self.seed)?;
        if let Some(nuisance) = self.nuisance {
            write!(f, "/{}", nuisance.name())?;
        }
        if self.touches != Touches::Family {
            write!(f, "/{}", self.touches.name())?;
        }
        self.cell.map_or(Ok(()), |cell| write!(f, "/{}={}", cell.axis.name(), cell.value))
    }
}

impl FromStr for CaseId {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut parts = text.split('/');
        let name = parts.next().unwrap_or_default();
        let family = family(name).ok_or_else(|| format!("`{name}` is no family"))?;
        let seed = parts.next().unwrap_or_default();
        let seed: u64 = seed.parse().map_err(|_| format!("`{seed}` is no seed"))?;
        Set::of(seed).ok_or_else(|| format!("{seed} is in no set of seeds"))?;
        let mut parts = parts.peekable();
        let named = |text: &&str| Nuisance::EACH.into_iter().chain([Nuisance::All]).find(|n| n.name() == *text);
        let nuisance = parts.peek().and_then(named);
        if nuisance.is_some() {
            parts.next();
        }
        let touched = |text: &&str| Touches::ALL.into_iter().find(|touches| touches.name() == *text);
        let touches = parts.peek().and_then(touched).filter(|touches| *touches != Touches::Family);
        if touches.is_some() {
            parts.next();
        }
        let touches = touches.unwrap_or_default();
        let cell = parts.next().map(cell).transpose()?;
        match parts.next() {
            None => Ok(Self { family: family.name.to_owned(), seed, nuisance, touches, cell }),
            Some(rest) => Err(format!("`{rest}` follows the id")),
        }
    }
}

fn cell(text: &str) -> Result<Cell, String> {
    let (name, value) = text.split_once('=').ok_or_else(|| format!("`{text}` is no nuisance, and not axis=value"))?;
    let axis = Axis::ALL.into_iter().find(|a| a.name() == name).ok_or_else(|| format!("`{name}` is no axis"))?;
    let value: f64 = value.parse().map_err(|_| format!("`{value}` is no number"))?;
    let (low, high) = (axis.values()[0], axis.values()[axis.values().len() - 1]);
    if (low..=high).contains(&value) {
        Ok(Cell { axis, value })
    } else {
        Err(format!("{name} is {low} to {high}, found {value}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_id_reads_back_as_it_was_written() {
        for text in [
            "bore/1001",
            "corner-far/7003/noise=2.5",
            "boss/100000/points=30",
            "bore/1001/stock-wave",
            "bore/1001/all/chosen",
            "wave/7001/chosen",
            "wave/7001/radius/advised/noise=3",
            "wave/7001/wear/noise=3",
        ] {
            assert_eq!(text.parse::<CaseId>().expect("an id").to_string(), text);
        }
        for text in [
            "bore",
            "bore/5",
            "bore/1001/noise=-1",
            "bore/1001/wind=1",
            "cave/1001",
            "bore/1001/noise=1/x",
            "bore/1001/chosen/all",
            "bore/1001/family",
        ] {
            assert!(text.parse::<CaseId>().is_err(), "{text}");
        }
    }
}
