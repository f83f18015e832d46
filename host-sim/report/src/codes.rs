//! Errors of tables that are drawn.

truepath_ground::codes! {
    Z009 => "a table with fewer than two places along the contour"
        / "give the table of a whole contour",
    Z011 => "a picture that is neither SVG nor PNG, or `--scale` for an SVG"
        / "name an output that ends in .svg or .png",
    Z012 => "a folder without the table, or a table without its wall.csv and without a job"
        / "name a folder as simulate, correct, learn or compare write it, or give --job",
    Z013 => "too many tables or laws, tables that do not go together, or a table of another job"
        / "give the tables of one job, or fewer of them",
    Z014 => "a summary that is not one of `compare`"
        / "summary.json lies beside walls.csv in the folder of compare",
}
