-- Whose a job is: the id of the token that submitted it, '' where no token was needed. Jobs of before
-- are those of the token that has their client's name, unless it was made after them. And when a job
-- ended by the clock that it grows old by (retention_clock.h).

ALTER TABLE jobs ADD COLUMN owner TEXT NOT NULL DEFAULT '';
ALTER TABLE jobs ADD COLUMN retained_ms INTEGER;

UPDATE jobs SET
    owner = coalesce((SELECT id FROM tokens WHERE 'token:' || name = jobs.client
                      AND tokens.created_ms <= jobs.created_ms), ''),
    retained_ms = finished_ms;
