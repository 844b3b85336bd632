-- Maps of one family differ in the photons asked for alone: a larger one continues a smaller. Maps
-- kept before have no family, and neither have those that are made as a whole.

ALTER TABLE maps ADD COLUMN family TEXT CHECK (length(family) = 64);
ALTER TABLE maps ADD COLUMN target INTEGER NOT NULL DEFAULT 0;  -- photons asked for
