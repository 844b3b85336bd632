-- Scenes, BSDFs, photon maps and jobs. Bytes live in files; rows say what they are.
-- Times are milliseconds since 1970, UTC. Digests are lower-case hexadecimal SHA-256.

CREATE TABLE scenes (
    id         TEXT PRIMARY KEY CHECK (length(id) = 64),
    created_ms INTEGER NOT NULL,
    bytes      INTEGER NOT NULL,
    summary    TEXT NOT NULL                       -- JSON, as GET /v1/scenes/{id} shows it
) STRICT, WITHOUT ROWID;

CREATE TABLE scene_files (
    scene    TEXT NOT NULL REFERENCES scenes (id) ON DELETE CASCADE,
    position INTEGER NOT NULL,                     -- main files in the order of the scene
    name     TEXT NOT NULL,
    resource INTEGER NOT NULL CHECK (resource IN (0, 1)),
    blob     TEXT NOT NULL CHECK (length(blob) = 64),
    bytes    INTEGER NOT NULL,
    PRIMARY KEY (scene, position),
    UNIQUE (scene, name)
) STRICT, WITHOUT ROWID;

CREATE TABLE bsdfs (
    id         TEXT PRIMARY KEY CHECK (length(id) = 64),  -- the blob's digest
    created_ms INTEGER NOT NULL,
    name       TEXT NOT NULL,
    bytes      INTEGER NOT NULL,
    summary    TEXT NOT NULL
) STRICT, WITHOUT ROWID;

CREATE TABLE maps (
    kind          TEXT NOT NULL,
    key           TEXT NOT NULL CHECK (length(key) = 64),
    emitted       INTEGER NOT NULL,
    stored        INTEGER NOT NULL,
    bytes         INTEGER NOT NULL,
    seconds       REAL NOT NULL,                   -- what building it took
    hits          INTEGER NOT NULL DEFAULT 0,
    seconds_saved REAL NOT NULL DEFAULT 0,
    created_ms    INTEGER NOT NULL,
    last_used_ms  INTEGER NOT NULL,
    PRIMARY KEY (kind, key)
) STRICT, WITHOUT ROWID;

CREATE TABLE jobs (
    seq         INTEGER PRIMARY KEY AUTOINCREMENT, -- the order of arrival
    id          TEXT NOT NULL UNIQUE,
    scene       TEXT NOT NULL REFERENCES scenes (id),
    document    TEXT NOT NULL CHECK (length(document) = 64), -- the blob with the job's JSON
    state       TEXT NOT NULL
                CHECK (state IN ('queued', 'running', 'succeeded', 'failed', 'cancelled')),
    attempts    INTEGER NOT NULL DEFAULT 0,
    created_ms  INTEGER NOT NULL,
    started_ms  INTEGER,
    finished_ms INTEGER,
    outcome     TEXT,                              -- JSON: timings, maps, files; once succeeded
    problem     TEXT                               -- JSON: RFC 9457; once failed
) STRICT;

CREATE INDEX jobs_by_scene ON jobs (scene);
