# An error that Python has set behind C, on its way to who called.
cdef extern from *:
    """
    #ifndef RS_RAISE_PENDING
    #define RS_RAISE_PENDING
    static int rs_raise_pending(void) { return -1; }   /* the error is already set */
    #endif
    """
    int rs_raise_pending() except -1
