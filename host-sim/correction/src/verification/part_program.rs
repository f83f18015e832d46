//! What the part's program says besides its contour: work offset, unit, and how high it moves.
//!
//! The verification program runs in the same work offset and unit, and between places at least as high as the part's
//! program ever was, so that clamps which the part's program passes over are passed over as well.

use truepath_core::gcode::{Canon, HostMemory, Interpreter, Units};
use truepath_ground::diagnostics::InputError;
use truepath_job::pass::Pass;

use crate::codes::V006;

/// What the part's program says.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PartProgram {
    /// Name of the program, without its folder.
    pub name: String,
    /// CRC-32 of its bytes.
    pub crc: u32,
    /// Unit of its words.
    pub units: Units,
    /// Work offset in force on the contour: G54 … G59.3 are 1 … 9, 9 + P of G54.1 and G154.
    pub work_offset: u16,
    /// Highest Z it moves to in program coordinates, nm; `None` when it names none.
    pub highest_nm: Option<i64>,
}

impl PartProgram {
    /// Reads it off the program.
    ///
    /// # Errors
    /// Whatever is wrong with the program; `V006` when G52 or G92 shifts its origin, because the verification program
    /// would have to shift it again.
    pub fn read(pass: &Pass) -> Result<Self, InputError> {
        let first = pass.core.contour.lines.first;
        let (mut work_offset, mut highest_nm, mut local) = (1, None, [0; 3]);
        let mut memory = Box::new(HostMemory::new());
        Interpreter::new(pass.job.numbers.program_options())
            .run(pass.program.bytes(), &mut memory.lend(), &mut |event| {
                if event.source.line == first {
                    work_offset = event.modal.work_offset;
                    let [x, y, z, ..] = event.modal.shifts.local;
                    local = [x, y, z];
                }
                if let Canon::Traverse { to, .. } | Canon::Feed { to, .. } = *event.canon {
                    highest_nm = highest_nm.max(to.z.map(|z| z.nm()));
                }
                Ok(())
            })
            .map_err(|error| InputError::of_program(&pass.program, &error))?;
        if local != [0; 3] {
            let (unit, name) = (pass.unit(), pass.unit().name());
            let [x, y, z] = local.map(|nm| unit.of(nm as f64 / 1e6));
            return Err(V006.error(
                format!("G52 or G92 has shifted the origin by X{x} Y{y} Z{z} {name} when line {first} is cut"),
                "a contour cut in a work offset alone: a verification program changes no origin",
            ));
        }
        let name = pass.program.name();
        let name = name.rsplit(['/', '\\']).next().unwrap_or(name).to_owned();
        Ok(Self { name, crc: pass.core.program_crc, units: pass.core.contour.units, work_offset, highest_nm })
    }
}
