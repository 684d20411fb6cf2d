CREATE TABLE result (
    task TEXT PRIMARY KEY,
    key TEXT NOT NULL,
    status TEXT NOT NULL,
    seconds REAL NOT NULL,
    count INTEGER NOT NULL,
    drawn TEXT NOT NULL,
    limits TEXT NOT NULL,
    finished TEXT NOT NULL,
    record TEXT NOT NULL,
    checksum TEXT NOT NULL
);
CREATE TABLE input (
    path TEXT PRIMARY KEY,
    stamp TEXT NOT NULL,
    digest TEXT NOT NULL,
    checksum TEXT NOT NULL
) WITHOUT ROWID;
