//! The corrections that are compared.

use truepath_core::correct::{DesignStep, Guarded, Law, Node, design, guarded_design};
use truepath_core::cut::Loop;
use truepath_core::geometry::Vector;
use truepath_core::job::{self, LawName};
use truepath_core::probe::Contact;
use truepath_core::units::{Offset, Real};
use truepath_correction::correction::{Buffers, Identification};
use truepath_ground::length::Unit;
use truepath_ground::units::mm;
use truepath_job::pass::Pass;

/// A correction by one of the laws.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// Name of the law.
    pub law: &'static str,
    /// What it is.
    pub title: &'static str,
    /// The correction, one entry per sample of the contour.
    pub nodes: Vec<Node>,
    /// What is to be known about it.
    pub remark: String,
}

/// Corrections by all laws from one measurement: none first, the model last. `progress` is told the share done, 0…1.
pub fn candidates(
    pass: &Pass,
    machine: &Loop,
    identified: &Identification,
    contacts: &[Contact],
    mut progress: impl FnMut(f64),
) -> Vec<Candidate> {
    let blank = vec![Node::default(); machine.path.count()];
    let mut out = vec![Candidate { law: "none", title: "no correction", nodes: blank, remark: String::new() }];
    out.push(constant(machine, contacts, pass.unit()));
    for (name, title, remark) in [
        (LawName::Mirror, "first-order mirror", "the deflection of the uncorrected cut reversed"),
        (LawName::Paper, "paper of 2023", ""),
    ] {
        let law = law(pass, machine, contacts, name);
        let nodes = unguarded(pass, machine, law);
        let remark = if name == LawName::Paper { paper_remark(&law) } else { remark.to_owned() };
        out.push(Candidate { law: truepath_correction::summary::law_name(&law), title, nodes, remark });
    }
    let (nodes, remark) = model(pass, machine, identified, &mut progress);
    out.push(Candidate { law: "model", title: "Truepath", nodes, remark });
    out
}

/// The best constant: the mean of the probed errors as a wear offset, towards the wall everywhere.
fn constant(machine: &Loop, contacts: &[Contact], unit: Unit) -> Candidate {
    let sum: Offset = contacts.iter().fold(Offset::ZERO, |sum, contact| sum + contact.error);
    let mean = sum.scaled(Real::ratio(1, contacts.len().max(1) as i64));
    let samples = machine.path.samples().iter().skip(machine.path.first()).take(machine.path.count());
    let nodes = samples.map(|sample| Node { chip: Vector::ZERO, edge: sample.normal.times(mean) }).collect();
    let remark = format!("wear offset of {:.4} {}, the mean of the probed errors", unit.of(mm(mean)), unit.name());
    Candidate { law: "constant", title: "constant offset", nodes, remark }
}

/// A law by name, with what it needs of the measurement.
fn law(pass: &Pass, machine: &Loop, contacts: &[Contact], name: LawName) -> Law {
    let mut core = pass.core.clone();
    core.job.correct.law = name;
    job::law(&core, machine, contacts)
}

/// The law of the paper divides by absolute coordinates and takes one probe for each axis.
fn paper_remark(law: &Law) -> String {
    let mut text = "P23 eqs. (8)-(12): depends on the origin of the program and on one probe per wall".to_owned();
    if let Law::Paper(transfer) = law {
        for (axis, ratio) in [("X", &transfer.x), ("Y", &transfer.y)] {
            if ratio.area == Real::ZERO {
                text += &format!("; no point on a wall across {axis}, so {axis} is not corrected");
            }
        }
    }
    text
}

fn unguarded(pass: &Pass, machine: &Loop, law: Law) -> Vec<Node> {
    let wanted = pass.job.numbers.design(law);
    let mut buffers = Buffers::of(machine.path);
    let mut nodes = vec![Node::default(); machine.path.count()];
    design(machine, &wanted, &mut nodes, &mut [], &mut buffers.workspace(&[], &[]), &mut |_| ());
    nodes
}

fn model(
    pass: &Pass,
    machine: &Loop,
    identified: &Identification,
    progress: &mut dyn FnMut(f64),
) -> (Vec<Node>, String) {
    let wanted = pass.job.numbers.design(Law::Model);
    let mut buffers = Buffers::of(machine.path);
    let mut nodes = vec![Node::default(); machine.path.count()];
    let mut made = Guarded { nodes: &mut nodes, unguarded: &mut [], predicted: &mut [], sigma: &mut [], damped: None };
    let belief = (identified.prior(), identified.fit());
    guarded_design(machine, belief, &wanted, &mut made, &mut buffers.workspace(&[], &[]), &mut |step| {
        if let DesignStep::Done { permille, .. } = step {
            progress(f64::from(permille) / 1000.0);
        }
    });
    let guard = wanted.max_gouge.map(|limit| format!("max_gouge_mm = {} wins over the target", mm(limit)));
    (nodes, guard.unwrap_or_default())
}
