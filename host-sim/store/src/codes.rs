//! Errors of the shop store.

truepath_ground::codes! {
    O001 => "a store that cannot be reached or opened"
        / "check the name, the server and the rights; truepath store init makes a new store",
    O002 => "no store there"
        / "make it with truepath store init, or name another place",
    O003 => "a store of another schema version"
        / "bring it up with truepath store migrate, or use the program that it was made with",
    O004 => "a store that takes nothing: it is full, or the right to write is missing"
        / "free the disk, or ask for the role of an operator; truepath store import takes the folder then",
    O005 => "no folder with a history"
        / "name folders that truepath correct or truepath learn has written",
    O006 => "no such job or history in the store, or several could be meant"
        / "name the number of a history, as truepath store status lists them",
    O007 => "no store is named"
        / "add --store, set TRUEPATH_STORE, or give [store] in the job",
    O008 => "a store that contradicts itself"
        / "restore the last backup, and import the folders written since",
}
