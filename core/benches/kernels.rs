//! Time of the kernels, by criterion: `cargo xtask bench`, or `cargo bench -p truepath-core -- engagement`.
mod kernel;

use criterion::{Criterion, criterion_group, criterion_main};
use std::time::Duration;

fn kernels(criterion: &mut Criterion) {
    for kernel in kernel::KERNELS {
        // Built only when it is asked for: the longest contour takes a second.
        let mut work = None;
        criterion.bench_function(kernel.name, |bencher| bencher.iter(work.get_or_insert_with(kernel.prepare)));
    }
}

criterion_group! {
    name = all;
    config = Criterion::default().sample_size(30).warm_up_time(Duration::from_millis(500)).measurement_time(Duration::from_secs(2));
    targets = kernels
}
criterion_main!(all);
