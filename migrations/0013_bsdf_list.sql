-- The list of BSDFs, those uploaded by themselves and the XML files of scenes: a row of each, with
-- what uses it, so that a page of the list costs the same however many scenes there are.

CREATE TABLE listed_bsdfs (
    id           TEXT PRIMARY KEY CHECK (length(id) = 64), -- the blob's digest
    created_ms   INTEGER NOT NULL,                         -- uploaded, or its first scene was
    name         TEXT NOT NULL,
    bytes        INTEGER NOT NULL,
    own          INTEGER NOT NULL CHECK (own IN (0, 1)),   -- uploaded by itself
    scenes       INTEGER NOT NULL,                         -- that have it as a file
    last_used_ms INTEGER NOT NULL                          -- uploaded, or such a scene was of use
) STRICT, WITHOUT ROWID;

CREATE INDEX listed_bsdfs_by_age ON listed_bsdfs (created_ms, id);

INSERT INTO listed_bsdfs (id, created_ms, name, bytes, own, scenes, last_used_ms)
SELECT b.id, b.created_ms, b.name, b.bytes, 1,
       (SELECT count(DISTINCT scene) FROM scene_files WHERE blob = b.id),
       max(b.created_ms, coalesce((SELECT max(s.last_used_ms) FROM scene_files f
                                   JOIN scenes s ON s.id = f.scene WHERE f.blob = b.id), 0))
FROM bsdfs b;

INSERT INTO listed_bsdfs (id, created_ms, name, bytes, own, scenes, last_used_ms)
SELECT f.blob, min(s.created_ms), min(f.name), f.bytes, 0, count(DISTINCT f.scene),
       max(s.last_used_ms)
FROM scene_files f JOIN scenes s ON s.id = f.scene
WHERE f.resource = 1 AND f.name LIKE '%.xml' AND f.blob NOT IN (SELECT id FROM bsdfs)
GROUP BY f.blob;

CREATE TRIGGER scene_files_are_listed AFTER INSERT ON scene_files
BEGIN
    UPDATE listed_bsdfs
    SET scenes = scenes + (NOT EXISTS (SELECT 1 FROM scene_files WHERE blob = NEW.blob
                                       AND scene = NEW.scene AND position <> NEW.position)),
        last_used_ms = max(last_used_ms, (SELECT last_used_ms FROM scenes WHERE id = NEW.scene))
    WHERE id = NEW.blob;
    INSERT INTO listed_bsdfs (id, created_ms, name, bytes, own, scenes, last_used_ms)
    SELECT NEW.blob, s.created_ms, NEW.name, NEW.bytes, 0,
           (SELECT count(DISTINCT scene) FROM scene_files WHERE blob = NEW.blob), s.last_used_ms
    FROM scenes s
    WHERE s.id = NEW.scene AND NEW.resource = 1 AND NEW.name LIKE '%.xml'
    AND NOT EXISTS (SELECT 1 FROM listed_bsdfs WHERE id = NEW.blob);
END;

CREATE TRIGGER scene_files_leave_the_list AFTER DELETE ON scene_files
BEGIN
    UPDATE listed_bsdfs
    SET scenes = scenes - (NOT EXISTS (SELECT 1 FROM scene_files
                                       WHERE blob = OLD.blob AND scene = OLD.scene))
    WHERE id = OLD.blob;
    DELETE FROM listed_bsdfs
    WHERE id = OLD.blob AND own = 0
    AND NOT EXISTS (SELECT 1 FROM scene_files
                    WHERE blob = OLD.blob AND resource = 1 AND name LIKE '%.xml');
    UPDATE listed_bsdfs
    SET name = (SELECT name FROM scene_files
                WHERE blob = OLD.blob AND resource = 1 AND name LIKE '%.xml' LIMIT 1)
    WHERE id = OLD.blob AND own = 0 AND name = OLD.name;
END;

CREATE TRIGGER bsdfs_are_listed AFTER INSERT ON bsdfs
BEGIN
    UPDATE listed_bsdfs
    SET own = 1, created_ms = NEW.created_ms, name = NEW.name,
        last_used_ms = max(last_used_ms, NEW.created_ms)
    WHERE id = NEW.id;
    INSERT INTO listed_bsdfs (id, created_ms, name, bytes, own, scenes, last_used_ms)
    SELECT NEW.id, NEW.created_ms, NEW.name, NEW.bytes, 1,
           (SELECT count(DISTINCT scene) FROM scene_files WHERE blob = NEW.id), NEW.created_ms
    WHERE NOT EXISTS (SELECT 1 FROM listed_bsdfs WHERE id = NEW.id);
END;

CREATE TRIGGER bsdfs_leave_the_list AFTER DELETE ON bsdfs -- which no scene has
BEGIN
    DELETE FROM listed_bsdfs WHERE id = OLD.id;
END;

CREATE TRIGGER scenes_use_their_bsdfs AFTER UPDATE OF last_used_ms ON scenes
BEGIN
    UPDATE listed_bsdfs
    SET last_used_ms = max(last_used_ms, NEW.last_used_ms)
    WHERE id IN (SELECT blob FROM scene_files WHERE scene = NEW.id AND resource = 1);
END;
