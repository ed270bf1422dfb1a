"""Plain, slow references written from the paper and from mechanics only; none but `second` imports rubnoise."""
