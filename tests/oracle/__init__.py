"""Plain, slow references written from the paper and from mechanics only; none of them imports rubnoise."""
