#include "gi/engine.h"

namespace lucarne::gi {

Result<void> Engine::draw(Frame& frame) {
    update(tracker_.next(frame));
    LUCARNE_TRY(prepare(frame));
    return render(frame);
}

}  // namespace lucarne::gi
