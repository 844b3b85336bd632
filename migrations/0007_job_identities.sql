-- What a job asks for, whatever its document looks like: jobs of one identity share a computation.

ALTER TABLE jobs ADD COLUMN identity TEXT NOT NULL DEFAULT '';
