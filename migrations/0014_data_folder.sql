-- The data folder that this database belongs to, which the file oriel.id names too, and the clock
-- by which what is kept grows old (retention_clock.h): its time and the wall's when it was saved.

CREATE TABLE data_folder (
    one         INTEGER PRIMARY KEY CHECK (one = 1),
    id          TEXT NOT NULL CHECK (length(id) = 32),
    retained_ms INTEGER NOT NULL,
    wall_ms     INTEGER NOT NULL
) STRICT;

INSERT INTO data_folder (one, id, retained_ms, wall_ms)
SELECT 1, lower(hex(randomblob(16))), now.ms, now.ms
FROM (SELECT CAST((julianday('now') - 2440587.5) * 86400000 AS INTEGER) AS ms) AS now;
