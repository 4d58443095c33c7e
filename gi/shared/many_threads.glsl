// Thread numbers for dispatches with more threads along x than OpenGL allows (it promises 65535 groups at least).
// Program::dispatch lays such threads out in rows. The last numbers may exceed the number of threads asked for.
uniform uint threads_a_row;  // 0: there is one row

uint thread_number() { return gl_GlobalInvocationID.x + gl_GlobalInvocationID.y * threads_a_row; }
