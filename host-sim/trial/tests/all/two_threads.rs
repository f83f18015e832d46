//! What two threads share gives the bits that the core gives on its own, as the device does.

use std::path::Path;

use truepath_core::correct::{
    Band, DesignWorkspace, Guarded, InOrder, Law, Node, Predicted, Profile, Scratch, WallReader, guarded_design,
};
use truepath_core::cut::{Loop, State, WallLaw};
use truepath_core::geometry::Vector;
use truepath_core::identify::PredictionWorkspace;
use truepath_core::job;
use truepath_core::units::Offset;
use truepath_correction::correction::{Buffers, DesignRequest, design_correction, identify};
use truepath_ground::diagnostics::Source;
use truepath_job::job::JobFile;
use truepath_job::measurement::Measurement;
use truepath_job::pass::{Pass, PathBuffer};
use truepath_plant::Machine;
use truepath_trial::virtual_mill;

const JOB: &str = include_str!("../../../demo/corner-helix/job.toml");
const PROGRAM: &str = include_str!("../../../demo/corner-helix/program.nc");
const HELICAL: &str = include_str!("../../../demo/corner-helix/plant.toml");

fn pass(keys: &str) -> Pass {
    let text = JOB.replace("[correct]", &format!("[correct]\n{keys}"));
    let job = JobFile::parse(Source::new("job.toml", text.into_bytes()), Path::new("")).unwrap();
    Pass::new(job, Source::new("program.nc", PROGRAM.as_bytes().to_vec())).unwrap()
}

/// Touched at three heights of five places; with `level`, as a wall that is the same at every height would be.
fn measured(pass: &Pass, level: bool) -> Measurement {
    let machine: Machine = toml::from_str(HELICAL).unwrap();
    let milled = virtual_mill::mill(pass, &machine, None).unwrap();
    let text = virtual_mill::probe(pass, &milled, &[20.0, 32.0, 49.0, 68.0, 80.0], &[0.1, 0.5, 0.9], 6.0).unwrap();
    let mut measurement = Measurement::read(pass, &Source::new("probe.txt", text.into_bytes())).unwrap();
    if level {
        for place in measurement.contacts.chunk_by_mut(|a, b| a.s == b.s) {
            let error = place[0].error;
            place.iter_mut().for_each(|contact| contact.error = error);
        }
    }
    measurement
}

#[test]
fn the_fits_under_both_laws_at_once_find_what_the_core_finds_one_after_the_other() {
    let pass = pass("");
    let mut buffer = PathBuffer::default();
    let path = pass.sample(&mut buffer).unwrap();
    for (level, law) in [(false, WallLaw::Helical), (true, WallLaw::Mean)] {
        let measurement = measured(&pass, level);
        let both = identify(&pass, &path, &measurement, |_| ()).unwrap();
        let mut observations = measurement.observations().unwrap();
        let needed = path.working().len() + 1;
        let mut workspace = PredictionWorkspace {
            states: &mut vec![State::REST; needed],
            displacements: &mut vec![Vector::ZERO; needed],
        };
        let alone = job::identified(&pass.core, &path, &mut observations, &mut workspace, &mut |_| ());
        assert_eq!((both.law(), alone.law), (law, law));
        assert_eq!(format!("{:?}", both.core), format!("{alone:?}"));
        assert_eq!(both.observations, observations);
    }
}

#[test]
#[ignore = "slow: cargo xtask test --all"]
fn a_design_that_reads_half_of_the_heights_elsewhere_is_the_one_that_reads_them_in_order() {
    for keys in ["", "max_gouge_mm = 0.02", "target = \"minimax\"\nband_mm = [2.0, 6.0]"] {
        let pass = pass(keys);
        let mut buffer = PathBuffer::default();
        let sampled = pass.sample(&mut buffer).unwrap();
        let identified = identify(&pass, &sampled, &measured(&pass, false), |_| ()).unwrap();
        let path = sampled.with_law(identified.law());
        let table = identified.table();
        let machine = identified.machine(&path, &table);
        let halves = design_correction(&pass, &machine, &identified, &DesignRequest::of(Law::Model), |_| ()).unwrap();
        let (count, working) = (path.count(), path.working().len());
        let mut workspace = DesignWorkspace {
            states: &mut vec![State::REST; working],
            displacements: &mut vec![Vector::ZERO; working],
            profiles: &mut vec![Profile::default(); count],
            updates: &mut vec![Default::default(); count],
            scratch: &mut vec![Scratch::default(); count],
            residual: &[],
            beside_sigma: &[],
            reader: InOrder,
        };
        let (mut nodes, mut unguarded) = (vec![Node::default(); count], vec![Node::default(); count]);
        let (mut predicted, mut sigma) = (vec![Predicted::default(); count], vec![Offset::ZERO; count]);
        let mut made = Guarded {
            nodes: &mut nodes,
            unguarded: &mut unguarded,
            predicted: &mut predicted,
            sigma: &mut sigma,
            damped: None,
        };
        let belief = (identified.prior(), identified.fit());
        let passage = guarded_design(&machine, belief, &halves.wanted, &mut made, &mut workspace, &mut |_| ());
        assert_eq!((halves.nodes, halves.unguarded), (nodes, unguarded), "{keys}");
        assert_eq!((halves.predicted, halves.sigma), (predicted, sigma), "{keys}");
        assert_eq!(halves.passage, passage, "{keys}");
    }
}

#[test]
fn a_profile_read_in_halves_is_the_one_read_in_order_also_where_no_wall_stands() {
    let pass = pass("");
    let mut buffer = PathBuffer::default();
    let path = pass.sample(&mut buffer).unwrap();
    let identified = identify(&pass, &path, &measured(&pass, false), |_| ()).unwrap();
    let table = identified.table();
    let machine = identified.machine(&path, &table);
    let working = path.working();
    let mut states = vec![State::REST; working.len()];
    machine.run(working.start, &mut states, |_| Vector::ZERO);
    let mut buffers = Buffers::of(&path);
    let in_order = read(InOrder, &machine, &states);
    assert_eq!(read(buffers.workspace(&[], &[]).reader, &machine, &states), in_order);
    // Read again into the same memory.
    assert_eq!(read(buffers.workspace(&[], &[]).reader, &machine, &states), in_order);
}

fn read(mut reader: impl WallReader, machine: &Loop, states: &[State]) -> Vec<Profile> {
    let mut walls = vec![Profile::default(); machine.path.count()];
    let mut displacements = vec![Vector::ZERO; states.len()];
    reader.profile(machine, states, Band::WHOLE, &mut displacements, &mut walls);
    walls
}
