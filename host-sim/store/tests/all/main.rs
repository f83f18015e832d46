//! The shop store on both back ends: bytes that come back, parts that come once, writers beside each other, processes that are
//! killed.

mod full;
mod killed;
mod round_trip;
mod scale;
mod server;
mod support;
mod writers;
