//! Work shared among all cores: cases are taken from a list one by one, results come back as they are finished.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc;

/// Calls `work` for every item on `threads` threads and hands each result to `done` on this one, in the order of
/// finishing; stops early when `done` fails.
///
/// # Errors
/// That of `done`.
pub fn for_each<I: Sync, O: Send, E>(
    items: &[I],
    threads: usize,
    work: impl Fn(&I) -> O + Sync,
    mut done: impl FnMut(O) -> Result<(), E>,
) -> Result<(), E> {
    let next = AtomicUsize::new(0);
    let (send, receive) = mpsc::channel();
    std::thread::scope(|scope| {
        for _ in 0..threads.clamp(1, items.len().max(1)) {
            let send = send.clone();
            let (next, work) = (&next, &work);
            scope.spawn(move || {
                while let Some(item) = items.get(next.fetch_add(1, Ordering::Relaxed)) {
                    if send.send(work(item)).is_err() {
                        break;
                    }
                }
            });
        }
        drop(send);
        for result in receive {
            if let Err(error) = done(result) {
                next.store(items.len(), Ordering::Relaxed);
                return Err(error);
            }
        }
        Ok(())
    })
}

/// Number of cores.
pub fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, std::num::NonZero::get)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_item_is_worked_on_once() {
        let items: Vec<u32> = (0..100).collect();
        let mut got = Vec::new();
        for_each(
            &items,
            4,
            |i| i * 2,
            |o| -> Result<(), ()> {
                got.push(o);
                Ok(())
            },
        )
        .expect("no error");
        got.sort_unstable();
        assert_eq!(got, (0..100).map(|i| i * 2).collect::<Vec<_>>());
        assert_eq!(for_each(&items, 2, |i| *i, |o| if o == 50 { Err(o) } else { Ok(()) }), Err(50));
    }
}
