-- What is kept has a budget: results may go to make room, and then the job says when. Jobs, scenes
-- and BSDFs can be removed; a scene when no job that waits or runs needs it, so that jobs that have
-- ended may outlive theirs.

CREATE TABLE jobs_anew (
    seq          INTEGER PRIMARY KEY AUTOINCREMENT, -- the order of arrival
    id           TEXT NOT NULL UNIQUE,
    kind         TEXT NOT NULL DEFAULT 'render',
    scene        TEXT NOT NULL CHECK (length(scene) = 64),
    document     TEXT NOT NULL CHECK (length(document) = 64),
    identity     TEXT NOT NULL DEFAULT '',
    priority     INTEGER NOT NULL DEFAULT 5 CHECK (priority BETWEEN 0 AND 9),
    client       TEXT NOT NULL DEFAULT '',
    request_key  TEXT,
    state        TEXT NOT NULL
                 CHECK (state IN ('queued', 'running', 'succeeded', 'failed', 'cancelled')),
    attempts     INTEGER NOT NULL DEFAULT 0,
    created_ms   INTEGER NOT NULL,
    started_ms   INTEGER,
    finished_ms  INTEGER,
    outcome      TEXT,
    problem      TEXT,
    result_bytes INTEGER NOT NULL DEFAULT 0,        -- of its results, once succeeded
    fetched_ms   INTEGER,                           -- when somebody asked for them last
    evicted_ms   INTEGER                            -- when they went to make room
) STRICT;

INSERT INTO jobs_anew (seq, id, kind, scene, document, identity, priority, client, request_key,
                       state, attempts, created_ms, started_ms, finished_ms, outcome, problem,
                       result_bytes)
SELECT seq, id, kind, scene, document, identity, priority, client, request_key, state, attempts,
       created_ms, started_ms, finished_ms, outcome, problem,
       CASE WHEN state = 'succeeded' AND json_valid(outcome)
            THEN coalesce((SELECT sum(json_extract(value, '$.bytes'))
                           FROM json_each(outcome, '$.files')), 0)
            ELSE 0 END
FROM jobs;

DROP TABLE jobs;
ALTER TABLE jobs_anew RENAME TO jobs;

CREATE INDEX jobs_by_scene ON jobs (scene);
CREATE INDEX jobs_by_document ON jobs (document);
CREATE INDEX jobs_by_request_key ON jobs (client, request_key) WHERE request_key IS NOT NULL;
CREATE INDEX scene_files_by_blob ON scene_files (blob);

CREATE TRIGGER jobs_begin_with_a_scene BEFORE INSERT ON jobs
WHEN NOT EXISTS (SELECT 1 FROM scenes WHERE id = NEW.scene)
BEGIN
    SELECT RAISE(ABORT, 'there is no such scene');
END;

CREATE TRIGGER scenes_stay_while_needed BEFORE DELETE ON scenes
WHEN EXISTS (SELECT 1 FROM jobs WHERE scene = OLD.id AND state IN ('queued', 'running'))
BEGIN
    SELECT RAISE(ABORT, 'jobs need the scene');
END;

CREATE TRIGGER bsdfs_stay_while_needed BEFORE DELETE ON bsdfs
WHEN EXISTS (SELECT 1 FROM scene_files WHERE blob = OLD.id)
BEGIN
    SELECT RAISE(ABORT, 'scenes need the BSDF');
END;
