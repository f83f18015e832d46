//! What a finishing process is.

use truepath_core::process::{Aim, Order, Slices};
use truepath_core::units::{Offset, Real};
use truepath_ground::length::Unit;
use truepath_ground::units::mm;

/// How a cut goes down the wall.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Levels {
    /// So many even levels, from the top; 1 is the whole depth.
    Even(usize),
    /// So many levels, of which all but the highest are this many slices deep: an integer axial contact ratio, at which the
    /// force does not change as the cutter turns.
    ContactRatio {
        /// Levels.
        count: usize,
        /// Depth of one as parts in a million of the wall's height.
        millionths: u32,
    },
}

/// One cut along the wall: all its levels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cut {
    /// What it is meant to leave.
    pub aim: Aim,
    /// How it goes down.
    pub levels: Levels,
    /// Against the direction of the program.
    pub reversed: bool,
    /// Percent of the programmed feed.
    pub feed_percent: u16,
    /// A spring pass: the commands of the cut before once more. A cut that aims anew has its own.
    pub spring: bool,
}

/// One pass of a cut, which the machine runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PassOrder {
    /// Direction, feed, and the slice of its tip.
    pub order: Order,
    /// What it is meant to leave.
    pub aim: Aim,
    /// How far its tip stays above that of the program, as a share of the wall's height.
    pub raised: Real,
}

impl PassOrder {
    /// Whether it brings the wall to size, and leaves nothing to another.
    pub const fn is_to_size(&self) -> bool {
        !matches!(self.aim, Aim::Least(_))
    }
}

impl Levels {
    /// Levels of one axial contact ratio on a wall, where they are more than one and no more than four.
    pub fn of_contact_ratio(contact_depth_mm: f64, wall_mm: f64) -> Option<Self> {
        let count = (wall_mm / contact_depth_mm - 1e-3).ceil() as usize;
        let millionths = (contact_depth_mm / wall_mm * 1e6).round() as u32;
        (2..=4).contains(&count).then_some(Self::ContactRatio { count, millionths })
    }

    /// How many passes it takes.
    pub const fn count(self) -> usize {
        match self {
            Self::Even(count) | Self::ContactRatio { count, .. } => count,
        }
    }

    /// The slices at whose lower borders the tips lie, from the top down.
    fn tips(self, slices: usize) -> Vec<usize> {
        let share = |level: usize| match self {
            Self::Even(count) => level as f64 / count as f64,
            Self::ContactRatio { millionths, .. } => level as f64 * f64::from(millionths) * 1e-6,
        };
        let tip = |level: usize| ((share(level) * slices as f64).round() as usize).min(slices - 1);
        let mut tips: Vec<usize> = (0..self.count()).rev().map(tip).collect();
        tips.dedup();
        tips
    }
}

impl Cut {
    /// The whole depth in one pass, as the program runs.
    pub const fn whole(aim: Aim) -> Self {
        Self { aim, levels: Levels::Even(1), reversed: false, feed_percent: 100, spring: false }
    }

    /// The passes of it, in order.
    pub fn orders(&self, slices: Slices) -> Vec<PassOrder> {
        let feed = Real::ratio(i64::from(self.feed_percent), 100);
        let order = |first: usize| PassOrder {
            order: Order { first, reversed: self.reversed, feed },
            aim: self.aim,
            raised: Real::ratio(first as i64, slices.count() as i64),
        };
        self.levels.tips(slices.count()).into_iter().map(order).collect()
    }

    /// In words, for a table, lengths in a unit.
    pub fn words(&self, unit: Unit) -> String {
        let mut words = match self.aim {
            _ if self.spring => "spring pass".to_owned(),
            Aim::Middle => "to size".to_owned(),
            Aim::Mean => "mean to size".to_owned(),
            Aim::Least(left) => format!("leave {:.0} {}", unit.small(mm(left)), unit.small_name()),
        };
        match self.levels {
            Levels::Even(1) => {}
            Levels::Even(count) => words += &format!(", {count} levels"),
            Levels::ContactRatio { count, .. } => words += &format!(", {count} levels of one contact ratio"),
        }
        if self.reversed {
            words += ", reversed";
        }
        if self.feed_percent != 100 {
            words += &format!(", feed {} %", self.feed_percent);
        }
        words
    }
}

/// The cuts of a process in words, lengths in a unit.
pub fn words(cuts: &[Cut], unit: Unit) -> String {
    cuts.iter().map(|cut| cut.words(unit)).collect::<Vec<_>>().join(" | ")
}

/// A pass before another that leaves at least so much, in whole micrometres.
pub const fn leaving(um: i64) -> Aim {
    Aim::Least(Offset::from_um(um))
}
