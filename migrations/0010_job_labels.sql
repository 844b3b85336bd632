-- What clients call their jobs by: a name, and tags as a JSON array of different texts. And when a
-- scene was last of use, which outlives the jobs that it was of use to.

ALTER TABLE jobs ADD COLUMN name TEXT;
ALTER TABLE jobs ADD COLUMN tags TEXT;

ALTER TABLE scenes ADD COLUMN last_used_ms INTEGER NOT NULL DEFAULT 0;

UPDATE scenes SET last_used_ms =
    max(created_ms, coalesce((SELECT max(created_ms) FROM jobs WHERE scene = scenes.id), 0));

CREATE INDEX scenes_by_age ON scenes (created_ms, id);
CREATE INDEX bsdfs_by_age ON bsdfs (created_ms, id);

CREATE TRIGGER scenes_come_into_use AFTER INSERT ON scenes
BEGIN
    UPDATE scenes SET last_used_ms = NEW.created_ms WHERE id = NEW.id;
END;

CREATE TRIGGER jobs_use_their_scene AFTER INSERT ON jobs
BEGIN
    UPDATE scenes SET last_used_ms = NEW.created_ms WHERE id = NEW.scene;
END;
