//! Parameters that follow the machine: position, tool, modes (LinuxCNC's `#5400`…`#5428` and predefined names).
//!
//! Lengths are in the unit of the program, those of the tool in the unit of the machine. What depends on an unknown
//! position reads 0.

use super::super::{FeedMode, MachineParameters, Memory, Number, Plane, RetractLevel, Spindle, Units};
use super::Execution;
use super::axes::turns;
use truepath_units::{Offset, Position};

impl MachineParameters for Execution<'_, '_, '_> {
    fn number(&self, number: u32) -> Option<f64> {
        match number {
            5400 => Some(f64::from(self.modal.tool.unwrap_or(0))),
            5401..=5409 => Some(self.spindle_offset(usize::try_from(number).ok()?.checked_sub(5401)?)),
            5410 => {
                let diameter = self.spindle_tool().map_or(Offset::ZERO, |tool| tool.diameter);
                Some(Number::of_nanometres(diameter.nm(), self.machine_units()))
            }
            5420..=5428 => Some(self.coordinate(usize::try_from(number).ok()?.checked_sub(5420)?)),
            // LinuxCNC shows its DEBUG comments until a program sets this to 0.
            5599 if self.memory.given(5599).is_none() => Some(1.0),
            _ => None,
        }
    }

    fn named(&self, name: &[u8]) -> Option<f64> {
        let name = name.strip_prefix(b"_")?;
        if let [letter] = name
            && let Some(axis) = b"xyzabcuvw".iter().position(|l| l == letter)
        {
            return Some(self.coordinate(axis));
        }
        if let Some([letter]) = name.strip_prefix(b"abs_")
            && let Some(axis) = b"xyzabcuvw".iter().position(|l| l == letter)
        {
            return Some(self.machine_coordinate(axis));
        }
        let modal = &self.modal;
        let inches = modal.units == Units::Inches;
        Some(match name {
            b"feed" => {
                let feed = modal.feed.unwrap_or_default();
                if inches && modal.feed_mode != FeedMode::InverseTime {
                    Number::of_real(feed, 254, 10)
                } else {
                    Number::of_real(feed, 1, 1)
                }
            }
            b"rpm" => Number::of_real(modal.speed.unwrap_or_default(), 1, 1),
            b"metric" => flag(!inches),
            b"imperial" => flag(inches),
            b"absolute" => flag(modal.absolute),
            b"incremental" => flag(!modal.absolute),
            b"inverse_time" => flag(modal.feed_mode == FeedMode::InverseTime),
            b"units_per_minute" => flag(modal.feed_mode == FeedMode::PerMinute),
            b"units_per_rev" => flag(modal.feed_mode == FeedMode::PerRevolution),
            b"coord_system" => f64::from(match modal.work_offset {
                system @ 1..=6 => system.saturating_add(53).saturating_mul(10),
                system => system.saturating_add(584),
            }),
            b"mist" => flag(self.coolant.0),
            b"flood" => flag(self.coolant.1),
            b"tool_offset" => flag(modal.length_offset),
            b"retract_r_plane" => flag(modal.retract == RetractLevel::Clearance),
            b"retract_old_z" => flag(modal.retract == RetractLevel::Before),
            b"spindle_on" => flag(modal.spindle != Spindle::Stopped),
            b"spindle_cw" => flag(modal.spindle == Spindle::Clockwise),
            b"spindle_rpm_mode" | b"lathe_radius_mode" | b"speed_override" | b"feed_override" | b"feed_hold" => 1.0,
            b"spindle_css_mode" | b"lathe_diameter_mode" | b"adaptive_feed" | b"task" | b"remap_level" | b"vminor" => {
                0.0
            }
            b"vmajor" => 2.9,
            b"ijk_absolute_mode" => flag(modal.absolute_centres),
            b"current_tool" => f64::from(modal.tool.unwrap_or(0)),
            b"selected_tool" => f64::from(modal.selected.unwrap_or(0)),
            b"current_pocket" => f64::from(self.pocket(modal.tool)),
            b"selected_pocket" => f64::from(self.pocket(modal.selected)),
            b"call_level" => f64::from(self.source.depth),
            b"line" => f64::from(self.reading),
            b"motion_mode" => f64::from(modal.motion.map_or(800, |motion| motion.code().tenths())),
            b"plane" => f64::from(match modal.plane {
                Plane::Xy => 170u16,
                Plane::Zx => 180,
                Plane::Yz => 190,
            }),
            b"ccomp" => f64::from(match modal.wall {
                None => 400u16,
                Some(truepath_units::geometry::Side::Right) => 410,
                Some(truepath_units::geometry::Side::Left) => 420,
            }),
            _ => return None,
        })
    }

    fn memory(&self) -> &Memory<'_> {
        self.memory
    }
}

const fn flag(on: bool) -> f64 {
    if on { 1.0 } else { 0.0 }
}

impl Execution<'_, '_, '_> {
    fn machine_units(&self) -> Units {
        self.options.machine.map_or(Units::Millimetres, |machine| machine.units)
    }

    fn spindle_tool(&self) -> Option<super::Tool> {
        self.tool_row(self.modal.tool.filter(|tool| *tool != 0)?)
    }

    fn pocket(&self, tool: Option<u32>) -> u32 {
        tool.and_then(|tool| self.tool_row(tool)).map_or(0, |tool| tool.pocket)
    }

    fn spindle_offset(&self, axis: usize) -> f64 {
        let offset = self.spindle_tool().and_then(|tool| tool.offset.get(axis).copied()).unwrap_or(0);
        Number::of_nanometres(offset, if turns(axis) { Units::Millimetres } else { self.machine_units() })
    }

    /// The machine coordinate of an axis in the unit of the program.
    fn machine_coordinate(&self, axis: usize) -> f64 {
        let value = self.machine_axes().get(axis).copied().flatten().unwrap_or(0);
        Number::of_nanometres(value, if turns(axis) { Units::Millimetres } else { self.modal.units })
    }

    /// The program coordinate of an axis in the unit of the program.
    fn coordinate(&self, axis: usize) -> f64 {
        let value = match axis.checked_sub(3).and_then(|a| self.modal.auxiliary.get(a)) {
            Some(value) => *value,
            None => self.at.get(axis).map_or(0, Position::nm),
        };
        Number::of_nanometres(value, if turns(axis) { Units::Millimetres } else { self.modal.units })
    }
}
