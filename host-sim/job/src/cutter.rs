//! Which of the cutters that a program names makes the contour, where the job says neither diameter nor number.

use truepath_core::gcode::{Criteria, Role};
use truepath_ground::codes::J008;
use truepath_ground::diagnostics::{InputError, Source};
use truepath_ground::length::Unit;
use truepath_ground::units::mm;

use crate::codes::J041;
use crate::feature::{LARGEST_SEARCH, Survey};
use crate::job::JobFile;
use crate::post::ToolNote;

/// Puts the cutter into a job that leaves it open.
///
/// # Errors
/// `J041` when several make contours or none is named, `J004` for teeth that nothing tells, and whatever is wrong with the
/// program.
pub(crate) fn settle(job: &mut JobFile, program: &Source) -> Result<(), InputError> {
    if job.cutters.is_empty() {
        return Ok(());
    }
    let survey = Survey::read(job, program)?;
    let unit = || Unit::at(program.bytes(), program.bytes().len());
    let mut runs = survey.runs.clone();
    let numbers = &job.numbers;
    let criteria = Criteria { tool: None, wall: numbers.wall, diameter: numbers.tool.diameter, named: false };
    if runs.len() <= LARGEST_SEARCH {
        survey.sort(&mut runs, &criteria);
    }
    let finishing = runs.iter().filter(|found| matches!(found.role, Role::Finish { .. }));
    let mut tools: Vec<u32> = finishing.filter_map(|found| found.run.tool).collect();
    tools.sort_unstable();
    tools.dedup();
    let named = |number: u32| job.cutters.iter().find(|cutter| cutter.number == Some(number));
    let cutter = match tools[..] {
        [only] => named(only).cloned(),
        _ => None,
    };
    let Some(cutter) = cutter else {
        let one = |cutter: &ToolNote| {
            let number = cutter.number.map_or_else(String::new, |n| format!("T{n}, "));
            format!("\n  {number}{} mm (line {}: {})", mm(cutter.diameter()), cutter.line, cutter.text)
        };
        let list: String = job.cutters.iter().map(one).collect();
        let found = format!("several cutters may make the contour:{list}");
        return Err(J041.error(found, "").told_in(unit()).with_keys_in(job.unit).at(job.source(), job.span("tool")));
    };
    let teeth = match (job.gives("tool.teeth"), cutter.teeth) {
        (true, _) => None,
        (false, Some(teeth)) => Some(teeth),
        (false, None) => {
            let found = format!("tool.teeth is missing for T{}", cutter.number.unwrap_or(0));
            let help = "add teeth under [tool]";
            let error = InputError::new(truepath_ground::codes::J004, found, "a whole number, 1 to 12", help);
            return Err(error.at(job.source(), job.span("tool")));
        }
    };
    let diameter = cutter.diameter();
    if numbers.allowance >= diameter {
        let found = format!("stock.allowance_mm is not below the diameter of the cutter, {} mm", mm(diameter));
        let error =
            InputError::new(J008, found, "a smaller allowance", "correct allowance_mm, or say diameter_mm in [tool]");
        return Err(error.told_in(unit()).with_keys_in(job.unit).at(job.source(), job.span("stock.allowance_mm")));
    }
    job.assumed.push(cutter.assumed("tool.diameter_mm", mm(diameter).to_string()));
    job.numbers.tool.diameter = diameter;
    if let Some(number) = cutter.number {
        job.assumed.push(cutter.assumed("tool.number", number.to_string()));
        job.numbers.tool.number = Some(number);
    }
    if let Some(teeth) = teeth {
        job.assumed.push(cutter.assumed("tool.teeth", teeth.to_string()));
        job.numbers.tool.teeth = u8::try_from(teeth).unwrap_or(1);
    }
    job.cutters.clear();
    Ok(())
}
