//! `report.html` as the commands write it, read back as the page reads it and held against the tables beside it.

mod cuts;
mod learned;
mod part;
mod passes;
mod reading;
mod tables;
mod unusual;
